//! An input report of a USB device → whether its button is down.

/// The bits of a report that mean that the button is down.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Pattern {
    /// The bits that count, byte by byte from the report's first.
    pub mask: Vec<u8>,
    /// Their values while the button is down.
    pub value: Vec<u8>,
}

impl Pattern {
    /// Whether the button is down; `None` for a report that is too short.
    pub(super) fn is_down(&self, report: &[u8]) -> Option<bool> {
        let bytes = report.get(..self.mask.len())?;
        let masked = bytes.iter().zip(&self.mask).map(|(byte, mask)| byte & mask);
        Some(masked.eq(self.value.iter().copied()))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_the_masked_bits_count() {
        let pattern = Pattern { mask: vec![0xff, 0x01], value: vec![0x02, 0x01] };
        assert_eq!(pattern.is_down(&[0x02, 0x01, 0x99]), Some(true));
        assert_eq!(pattern.is_down(&[0x02, 0xf1]), Some(true));
        assert_eq!(pattern.is_down(&[0x02, 0xf0]), Some(false));
        assert_eq!(pattern.is_down(&[0x03, 0x01]), Some(false));
    }

    #[test]
    fn a_report_that_is_too_short_says_nothing() {
        let pattern = Pattern { mask: vec![0, 1], value: vec![0, 1] };
        assert_eq!(pattern.is_down(&[1]), None);
        assert_eq!(pattern.is_down(&[]), None);
    }
}
