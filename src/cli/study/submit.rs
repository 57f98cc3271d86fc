//! `mechanim study submit`: the script that runs a study on a cluster. A job is a worker that takes units until none is
//! left, never a unit: schedulers are slow with many small jobs.

use crate::cli::args::sweep::{Engine, SubmitArgs};
use crate::cli::io;
use crate::cli::term::Term;
use crate::cli::term::outcome::{Failure, Outcome};
use crate::export::{Output, PendingFile};
use crate::parts::folder::Folder;
use std::path::{Path, PathBuf};
use std::process::Command;

/// Seconds between SIGTERM and SIGKILL requested from schedulers, so that the current unit can be written.
const GRACE: u32 = 30;

/// Writes the script, and submits it to the cluster.
pub fn submit(args: &SubmitArgs, term: &Term) -> Result<Outcome, Failure> {
    let folder = Folder::open(&args.folder)?;
    let job = ClusterJob::new(args, folder.path())?;
    let (name, script, command) = match args.to {
        Engine::Slurm => ("submit-slurm.sh", job.slurm_script(), vec!["sbatch"]),
        Engine::Ray => ("submit-ray.py", job.ray_script(), vec!["python3"]),
        Engine::Hq => ("submit-hq.sh", job.hyper_queue(), vec!["bash"]),
        Engine::Kubernetes => (
            "submit-kubernetes.yaml",
            job.kubernetes_script(),
            vec!["kubectl", "create", "-f"],
        ),
    };
    if args.dry_run {
        io::print_beside(term, None, &script)?;
        return Ok(Outcome::Done);
    }
    let path = job.folder.join(name);
    let mut target = PendingFile::create(&path)?;
    target.emit(script.as_bytes())?;
    // If a study were submitted twice at once, half of the workers would wait for the others.
    if !target.commit_new()? {
        let message = format!("{} exists: the study was submitted", path.display());
        let hint = "remove it to submit the missing units again";
        return Err(Failure::usage(message, vec![hint.to_owned()]));
    }
    hand_over(&command, &path)?;
    Ok(Outcome::Done)
}

fn hand_over(command: &[&str], script: &Path) -> Result<(), Failure> {
    let Some((program, arguments)) = command.split_first() else {
        return Ok(());
    };
    let status = Command::new(program).args(arguments).arg(script).status();
    let why = match status {
        Ok(status) if status.success() => return Ok(()),
        Ok(status) => format!("`{program}` failed: {status}"),
        Err(error) => format!("`{program}` could not be started: {error}"),
    };
    // Nothing was submitted, so that it can be tried again.
    let _ = std::fs::remove_file(script);
    let hint = "--dry-run prints the script without submitting it";
    Err(Failure::usage(why, vec![hint.to_owned()]))
}

/// The common part of all scripts.
struct ClusterJob {
    folder: PathBuf,
    program: PathBuf,
    workers: usize,
    threads: usize,
    image: String,
}

impl ClusterJob {
    fn new(args: &SubmitArgs, folder: &Path) -> Result<Self, Failure> {
        let refused = |what: &str, e: std::io::Error| {
            Failure::usage(format!("{what} has no full path: {e}"), Vec::new())
        };
        let job = Self {
            folder: folder
                .canonicalize()
                .map_err(|e| refused("the folder", e))?,
            program: std::env::current_exe().map_err(|e| refused("the program", e))?,
            workers: args.workers,
            threads: args.threads,
            image: args.image.clone(),
        };
        for path in [&job.folder, &job.program] {
            if path.to_str().is_none_or(|text| text.contains(['\n', '\r'])) {
                let message = format!("{} cannot be written into a script", path.display());
                return Err(Failure::usage(message, Vec::new()));
            }
        }
        Ok(job)
    }

    fn slurm_script(&self) -> String {
        let Self {
            workers, threads, ..
        } = self;
        let command = self.shell_command("$((SLURM_ARRAY_TASK_ID + 1))");
        format!(
            "#!/bin/bash
# A worker for every task of the array; `sbatch --array` of `mechanim study merge DIR --missing` is not needed: a
# worker finds what is missing.
#SBATCH --job-name=mechanim
#SBATCH --array=0-{}
#SBATCH --cpus-per-task={threads}
#SBATCH --signal=TERM@{GRACE}
#SBATCH --requeue
#SBATCH --open-mode=append
#SBATCH --output={}/slurm-%a.log
exec {command}
",
            workers - 1,
            // sbatch would take a percent sign for a pattern.
            self.folder.display().to_string().replace('%', "%%")
        )
    }

    fn hyper_queue(&self) -> String {
        let Self {
            workers, threads, ..
        } = self;
        let command = self.shell_command("$((HQ_TASK_ID + 1))");
        format!(
            "#!/bin/bash
# An array of workers. A worker that is lost is started again by HyperQueue.
exec hq submit --name mechanim --array 0-{} --cpus {threads} --crash-limit 5 -- bash -c {}
",
            workers - 1,
            shell_word(&format!("exec {command}"))
        )
    }

    fn ray_script(&self) -> String {
        format!(
            "\"\"\"Workers of a study as tasks of Ray; the files of the study are the result.\"\"\"

import ctypes
import os
import signal
import subprocess

import ray

PROGRAM = {}
FOLDER = {}
WORKERS = {}
THREADS = {}


def dies_with_its_parent():
    \"\"\"A worker of Ray that is killed must not leave the program behind (Linux).\"\"\"
    try:
        ctypes.CDLL(None).prctl(1, signal.SIGTERM)
    except (OSError, AttributeError):
        pass


@ray.remote(num_cpus=THREADS, max_retries=5)
def work(index):
    command = [PROGRAM, \"study\", \"run\", FOLDER, \"--worker\", f\"{{index}}/{{WORKERS}}\"]
    command += [\"--threads\", str(THREADS)]
    done = subprocess.run(command, preexec_fn=dies_with_its_parent, check=False)
    # What the program refuses it refuses everywhere: no reason to try again.
    if done.returncode not in (0, 2):
        os._exit(1)
    return done.returncode


if __name__ == \"__main__\":
    ray.init(address=os.environ.get(\"RAY_ADDRESS\"))
    codes = ray.get([work.remote(index) for index in range(1, WORKERS + 1)])
    raise SystemExit(max(codes))
",
            python_text(&self.program.display().to_string()),
            python_text(&self.folder.display().to_string()),
            self.workers,
            self.threads
        )
    }

    fn kubernetes_script(&self) -> String {
        let Self {
            workers, threads, ..
        } = self;
        let command = format!(
            "exec mechanim study run /study --worker $((JOB_COMPLETION_INDEX + 1))/{workers} --threads {threads}"
        );
        format!(
            "# Needs a volume that all nodes can write to; its claim is called `mechanim-study` here and holds the study at its
# root. Not tried on a cluster by whoever wrote this program.
apiVersion: batch/v1
kind: Job
metadata:
  generateName: mechanim-
spec:
  completionMode: Indexed
  completions: {workers}
  parallelism: {workers}
  backoffLimitPerIndex: 5
  podFailurePolicy:
    rules:
      - action: FailIndex
        onExitCodes:
          operator: In
          values: [2]
  template:
    spec:
      restartPolicy: Never
      terminationGracePeriodSeconds: {GRACE}
      containers:
        - name: worker
          image: {}
          command: [\"sh\", \"-c\", {}]
          resources:
            requests:
              cpu: \"{threads}\"
          volumeMounts:
            - name: study
              mountPath: /study
      volumes:
        - name: study
          persistentVolumeClaim:
            claimName: mechanim-study
",
            json_text(&self.image),
            json_text(&command)
        )
    }

    /// The command of a worker whose number is the shell's `own`.
    fn shell_command(&self, own: &str) -> String {
        format!(
            "{} study run {} --worker \"{own}/{}\" --threads {}",
            shell_word(&self.program.display().to_string()),
            shell_word(&self.folder.display().to_string()),
            self.workers,
            self.threads
        )
    }
}

/// A text as one word of a shell.
pub(crate) fn shell_word(text: &str) -> String {
    format!("'{}'", text.replace('\'', "'\\''"))
}

/// A quoted text, as JSON and YAML read it.
fn json_text(text: &str) -> String {
    serde_json::Value::from(text).to_string()
}

/// A quoted text, as Python reads it: a JSON text without surrogates is one.
fn python_text(text: &str) -> String {
    json_text(text)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn no_name_leaves_its_quotes() {
        assert_eq!(shell_word("a 'b' $(c)"), "'a '\\''b'\\'' $(c)'");
        assert_eq!(json_text("a\"b\\c"), "\"a\\\"b\\\\c\"");
    }
}
