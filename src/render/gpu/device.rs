//! A device with its queue, and how its failures become errors instead of hangs and panics.

use crate::render::RenderError;
use std::sync::{Arc, Mutex, PoisonError, mpsc};
use std::time::Duration;

/// Longest time for one picture. A software adapter needs a tenth of a second for a large one; a device that does not
/// answer for this long is lost.
const PATIENCE: Duration = Duration::from_secs(60);

/// An open device; clones are the same one.
#[derive(Clone)]
pub struct Device {
    /// wgpu's device.
    pub device: wgpu::Device,
    /// Its queue.
    pub queue: wgpu::Queue,
    /// Samples per pixel the adapter can draw in our formats.
    pub sample_counts: Vec<u32>,
    fault: Fault,
}

/// The first failure reported asynchronously.
#[derive(Clone, Default)]
struct Fault(Arc<Mutex<Option<String>>>);

impl Fault {
    fn set(&self, message: String) {
        let mut first = self.0.lock().unwrap_or_else(PoisonError::into_inner);
        first.get_or_insert(message);
    }

    fn get(&self) -> Option<String> {
        self.0
            .lock()
            .unwrap_or_else(PoisonError::into_inner)
            .clone()
    }
}

impl Device {
    /// Opens a device with the weakest limits, except for sizes.
    pub fn open(adapter: &wgpu::Adapter) -> Result<Self, RenderError> {
        let own = adapter.limits();
        // Without this feature every adapter has 1 and 4 samples.
        let wanted = wgpu::Features::TEXTURE_ADAPTER_SPECIFIC_FORMAT_FEATURES;
        let features = adapter.features() & wanted;
        let descriptor = wgpu::DeviceDescriptor {
            label: Some("mechanim"),
            required_features: features,
            required_limits: wgpu::Limits {
                max_texture_dimension_2d: own.max_texture_dimension_2d,
                max_buffer_size: own.max_buffer_size,
                ..wgpu::Limits::downlevel_webgl2_defaults()
            },
            ..wgpu::DeviceDescriptor::default()
        };
        let (device, queue) = pollster::block_on(adapter.request_device(&descriptor))
            .map_err(|e| RenderError::Device(e.to_string()))?;
        let fault = Fault::default();
        let (on_error, on_loss) = (fault.clone(), fault.clone());
        device.on_uncaptured_error(Arc::new(move |e: wgpu::Error| on_error.set(e.to_string())));
        device.set_device_lost_callback(move |reason, message| {
            if reason != wgpu::DeviceLostReason::Destroyed {
                on_loss.set(format!("the device was lost: {message}"));
            }
        });
        let sample_counts = if features.is_empty() {
            vec![1, 4]
        } else {
            supported_sample_counts(adapter)
        };
        Ok(Self {
            device,
            queue,
            sample_counts,
            fault,
        })
    }

    /// An error if the device has reported a failure since it was opened.
    pub fn check(&self) -> Result<(), RenderError> {
        self.fault
            .get()
            .map_or(Ok(()), |message| Err(RenderError::Device(message)))
    }

    /// Waits until a submission is done.
    pub fn wait(&self, submission: wgpu::SubmissionIndex) -> Result<(), RenderError> {
        let request = wgpu::PollType::Wait {
            submission_index: Some(submission),
            timeout: Some(PATIENCE),
        };
        let answer = self.device.poll(request);
        self.check()?;
        answer
            .map(|_| ())
            .map_err(|e| RenderError::Device(e.to_string()))
    }

    /// Waits for a submission that fills `buffer` and shows its bytes to `read`.
    pub fn read_back(
        &self,
        buffer: &wgpu::Buffer,
        submission: wgpu::SubmissionIndex,
        read: impl FnOnce(&[u8]),
    ) -> Result<(), RenderError> {
        let (sender, receiver) = mpsc::channel();
        buffer.map_async(wgpu::MapMode::Read, .., move |outcome| {
            // The receiver is gone only if this call has already failed.
            let _ = sender.send(outcome);
        });
        self.wait(submission)?;
        let failed =
            |e: String| RenderError::Device(format!("the picture could not be read back: {e}"));
        match receiver.recv_timeout(PATIENCE) {
            Ok(outcome) => outcome.map_err(|e| failed(e.to_string()))?,
            Err(e) => return Err(failed(e.to_string())),
        }
        let bytes = buffer
            .get_mapped_range(..)
            .map_err(|e| failed(e.to_string()))?;
        read(&bytes);
        drop(bytes);
        buffer.unmap();
        self.check()
    }
}

fn supported_sample_counts(adapter: &wgpu::Adapter) -> Vec<u32> {
    let colour = adapter
        .get_texture_format_features(super::formats::COLOUR_FORMAT)
        .flags;
    let depth = adapter
        .get_texture_format_features(super::formats::DEPTH_FORMAT)
        .flags;
    let surface = adapter
        .get_texture_format_features(super::formats::SURFACE_FORMAT)
        .flags;
    let resolvable = wgpu::TextureFormatFeatureFlags::MULTISAMPLE_RESOLVE;
    let shared = (colour & depth & surface).supported_sample_counts();
    shared
        .into_iter()
        .filter(|count| *count == 1 || colour.contains(resolvable))
        .collect()
}

/// The supported number of samples nearest to the asked one by ratio; the larger of two equally near.
pub fn nearest_sample_count(asked: u32, supported: &[u32]) -> u32 {
    let distance = |count: u32| {
        let (low, high) = (count.min(asked).max(1), count.max(asked));
        f64::from(high) / f64::from(low)
    };
    supported
        .iter()
        .copied()
        .min_by(|a, b| distance(*a).total_cmp(&distance(*b)).then(b.cmp(a)))
        .unwrap_or(1)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sample_counts_go_to_the_nearest() {
        assert_eq!(nearest_sample_count(1, &[1, 4]), 1);
        assert_eq!(nearest_sample_count(2, &[1, 4]), 4);
        assert_eq!(nearest_sample_count(2, &[1, 2, 4]), 2);
        assert_eq!(nearest_sample_count(16, &[1, 2, 4, 8]), 8);
        assert_eq!(nearest_sample_count(0, &[1, 4]), 1);
    }
}
