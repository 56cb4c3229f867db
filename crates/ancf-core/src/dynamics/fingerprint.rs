//! Which motion a checkpoint belongs to.

use std::fmt::{Debug, Write};

use crate::error::InputError;
use crate::model::Model;

use super::Options;

/// Digests of everything that a motion depends on.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Fingerprint(pub [u64; 4]);

/// What each digest is of.
const PARTS: [&str; 4] = ["bodies", "supports", "loads", "options"];

impl Fingerprint {
    /// The digests for a model and the way it is run.
    pub fn of(model: &Model, options: &Options) -> Self {
        Self([
            digest(&(model.bodies(), model.reference())),
            digest(&(model.fixed(), model.moved(), model.motions())),
            digest(&model.loads()),
            digest(options),
        ])
    }

    /// Checks that a run goes on as it began.
    ///
    /// # Errors
    ///
    /// Says what differs.
    pub fn check(&self, run: &Self) -> Result<(), InputError> {
        for ((part, own), other) in PARTS.iter().zip(self.0).zip(run.0) {
            let given = format!("that of a run with other {part}");
            InputError::check("checkpoint", given, own == other, "that of the same model, run in the same way")?;
        }
        Ok(())
    }
}

/// The digest of what is shown of a value: all of it, and numbers to the last bit.
///
/// # Source
///
/// Fowler, Noll and Vo (1991), FNV-1a, 64 bits.
fn digest(value: &dyn Debug) -> u64 {
    struct Digest(u64);
    impl Write for Digest {
        fn write_str(&mut self, text: &str) -> std::fmt::Result {
            for byte in text.bytes() {
                self.0 = (self.0 ^ u64::from(byte)).wrapping_mul(0x100_0000_01b3);
            }
            Ok(())
        }
    }
    let mut digest = Digest(0xcbf2_9ce4_8422_2325);
    write!(digest, "{value:?}").expect("a digest takes any text");
    digest.0
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The published value for "a", shown without quotes as an identifier.
    #[test]
    fn the_digest_is_the_published_one() {
        #[derive(Debug)]
        #[expect(non_camel_case_types, reason = "shown as the text of the published value")]
        struct a;
        assert_eq!(digest(&a), 0xaf63_dc4c_8601_ec8c);
    }

    #[test]
    fn the_last_bit_of_a_number_counts() {
        assert_ne!(digest(&0.1), digest(&0.1_f64.next_up()));
    }
}
