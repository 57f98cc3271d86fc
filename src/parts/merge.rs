//! Merging parts: all items in order, whatever the units were, or the reasons why it is impossible.

use super::error::PartsError;
use super::folder::Folder;
use super::part::PartFile;
use super::plan::PartContent;
use std::ops::Range;

/// Takes an item and its numbers.
type PartItems<'g, E> = dyn FnMut(u64, &[f64]) -> Result<(), E> + 'g;

/// Maximum number of faults that are listed.
const MOST_FAULTS: usize = 50;

/// Parts that cover all items.
pub struct Merge {
    parts: Vec<PartFile>,
    width: usize,
}

impl Merge {
    /// Checks which parts exist.
    ///
    /// Errors: a line for every file that does not belong here or is damaged, and for every range of items that is
    /// missing.
    pub fn new(folder: &Folder) -> Result<Self, PartsError> {
        let (parts, mut faults) = folder.parts()?;
        let mut next = 0;
        let mut said = |items: Range<u64>, what: &str| {
            if !items.is_empty() {
                let (first, last) = (items.start, items.end - 1);
                faults.push(format!("items {first} to {last}: {what}"));
            }
        };
        for part in &parts {
            said(next..part.items.start, "missing");
            if folder.plan.keeps == PartContent::Sums {
                // Sums cannot be compared item by item.
                let common = part.items.start..next.min(part.items.end);
                said(common, "in two parts, of sums");
            }
            next = next.max(part.items.end);
        }
        said(next..folder.plan.items, "missing");
        match faults.is_empty() {
            true => Ok(Self {
                parts,
                width: folder.plan.width as usize,
            }),
            false => Err(PartsError::Faulty(shortened_list(faults))),
        }
    }

    /// Passes on every item with its numbers, in order. One part is in memory at a time.
    ///
    /// Errors: a part whose bytes have changed; two parts with different numbers for the same item; an error of `give`.
    pub fn each<E: From<PartsError>>(&self, give: &mut PartItems<'_, E>) -> Result<(), E> {
        let mut next = 0;
        // Earlier parts that overlap the current one: usually none.
        let mut over: Vec<&PartFile> = Vec::new();
        for part in &self.parts {
            let numbers = part.numbers().map_err(as_fault)?;
            over.retain(|other| other.items.end > part.items.start);
            for other in &over {
                self.compare_part(other, part, &numbers)?;
            }
            over.push(part);
            let rows = part.items.clone().zip(numbers.chunks_exact(self.width));
            for (item, row) in rows.skip_while(|(item, _)| *item < next) {
                give(item, row)?;
            }
            next = next.max(part.items.end);
        }
        Ok(())
    }

    /// Passes on the numbers of every part, in the order of their items. One part is in memory at a time.
    ///
    /// Errors: a part whose bytes have changed; an error of `give`.
    pub fn each_part<E: From<PartsError>>(
        &self,
        give: &mut dyn FnMut(&[f64]) -> Result<(), E>,
    ) -> Result<(), E> {
        for part in &self.parts {
            give(&part.numbers().map_err(as_fault)?)?;
        }
        Ok(())
    }

    /// Compares a part with an earlier one where they have items in common.
    fn compare_part(
        &self,
        other: &PartFile,
        part: &PartFile,
        numbers: &[f64],
    ) -> Result<(), PartsError> {
        let common = part.items.start..part.items.end.min(other.items.end);
        if common.is_empty() {
            return Ok(());
        }
        let others = other.numbers().map_err(as_fault)?;
        let row = |part: &PartFile, numbers: &[f64], item: u64| -> Vec<u64> {
            let start = (item - part.items.start) as usize * self.width;
            let row = &numbers[start..start + self.width];
            row.iter().map(|number| number.to_bits()).collect()
        };
        for item in common {
            if row(other, &others, item) != row(part, numbers, item) {
                return Err(PartsError::Faulty(vec![format!(
                    "item {item} has other numbers in {} than in {}: one of the machines, or one of the programs, is at fault",
                    part.path.display(),
                    other.path.display()
                )]));
            }
        }
        Ok(())
    }
}

/// A damaged part prevents merging, like a missing one.
fn as_fault(error: PartsError) -> PartsError {
    match error {
        PartsError::Foreign { .. } => PartsError::Faulty(vec![error.to_string()]),
        other => other,
    }
}

fn shortened_list(mut faults: Vec<String>) -> Vec<String> {
    let all = faults.len();
    faults.truncate(MOST_FAULTS);
    if all > MOST_FAULTS {
        faults.push(format!("and {} more", all - MOST_FAULTS));
    }
    faults
}
