//! Little-endian CDR, the encoding of ROS 2 messages: numbers are aligned to their size, counted from the end of the header.

/// Representation: plain CDR, little-endian, no options.
const HEADER: [u8; 4] = [0, 1, 0, 0];

/// A message that is being written.
pub(super) struct Cdr(Vec<u8>);

impl Cdr {
    pub(super) fn new() -> Self {
        Self(HEADER.to_vec())
    }

    pub(super) fn finish(self) -> Vec<u8> {
        self.0
    }

    fn align(&mut self, size: usize) {
        let length = self.0.len() - HEADER.len();
        self.0.resize(HEADER.len() + length.next_multiple_of(size), 0);
    }

    pub(super) fn write_u8(&mut self, value: u8) {
        self.0.push(value);
    }

    pub(super) fn write_i32(&mut self, value: i32) {
        self.align(4);
        self.0.extend(value.to_le_bytes());
    }

    pub(super) fn write_u32(&mut self, value: u32) {
        self.align(4);
        self.0.extend(value.to_le_bytes());
    }

    /// An array of fixed length.
    pub(super) fn write_f64s(&mut self, values: &[f64]) {
        for value in values {
            self.align(8);
            self.0.extend(value.to_le_bytes());
        }
    }

    /// The length of a sequence.
    pub(super) fn write_length(&mut self, length: usize) {
        // Pictures have at most 64 million pixels, so their bytes fit.
        self.write_u32(u32::try_from(length).unwrap_or(u32::MAX));
    }

    pub(super) fn write_text(&mut self, text: &str) {
        self.write_length(text.len() + 1);
        self.0.extend(text.as_bytes());
        self.0.push(0);
    }

    /// A sequence of bytes.
    pub(super) fn write_bytes(&mut self, bytes: &[u8]) {
        self.write_length(bytes.len());
        self.0.extend(bytes);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_are_aligned_after_the_header() {
        let mut cdr = Cdr::new();
        cdr.write_u8(7);
        cdr.write_u32(1);
        cdr.write_text("ab");
        cdr.write_f64s(&[1.0]);
        let before = [0, 1, 0, 0, 7, 0, 0, 0, 1, 0, 0, 0, 3, 0, 0, 0, b'a', b'b', 0, 0];
        assert_eq!(cdr.finish(), [&before[..], &1.0f64.to_le_bytes()].concat());
    }
}
