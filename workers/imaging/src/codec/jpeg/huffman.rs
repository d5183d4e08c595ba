//! Huffman codes of the JPEG standard (ITU-T T.81, annex K.3) and the stream of bits that they make.

/// A table as the file states it.
pub(super) struct Table {
    /// How many codes have each length, from 1 bit.
    pub(super) lengths: [u8; 16],
    /// What the codes stand for, shortest first.
    pub(super) symbols: &'static [u8],
}

/// A code and its bits, for each symbol.
pub(super) type Codes = [(u16, u8); 256];

pub(super) const LUMA_DC: Table = Table {
    lengths: [0, 1, 5, 1, 1, 1, 1, 1, 1, 0, 0, 0, 0, 0, 0, 0],
    symbols: &[0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11],
};
pub(super) const CHROMA_DC: Table = Table {
    lengths: [0, 3, 1, 1, 1, 1, 1, 1, 1, 1, 1, 0, 0, 0, 0, 0],
    symbols: &[0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11],
};
pub(super) const LUMA_AC: Table = Table {
    lengths: [0, 2, 1, 3, 3, 2, 4, 3, 5, 5, 4, 4, 0, 0, 1, 125],
    symbols: b"\x01\x02\x03\x00\x04\x11\x05\x12\x21\x31\x41\x06\x13\x51\x61\x07\x22\x71\x14\x32\x81\x91\xa1\x08\x23\x42\xb1\
        \xc1\x15\x52\xd1\xf0\x24\x33\x62\x72\x82\x09\x0a\x16\x17\x18\x19\x1a\x25\x26\x27\x28\x29\x2a\x34\x35\x36\x37\
        \x38\x39\x3a\x43\x44\x45\x46\x47\x48\x49\x4a\x53\x54\x55\x56\x57\x58\x59\x5a\x63\x64\x65\x66\x67\x68\x69\x6a\
        \x73\x74\x75\x76\x77\x78\x79\x7a\x83\x84\x85\x86\x87\x88\x89\x8a\x92\x93\x94\x95\x96\x97\x98\x99\x9a\xa2\xa3\
        \xa4\xa5\xa6\xa7\xa8\xa9\xaa\xb2\xb3\xb4\xb5\xb6\xb7\xb8\xb9\xba\xc2\xc3\xc4\xc5\xc6\xc7\xc8\xc9\xca\xd2\xd3\
        \xd4\xd5\xd6\xd7\xd8\xd9\xda\xe1\xe2\xe3\xe4\xe5\xe6\xe7\xe8\xe9\xea\xf1\xf2\xf3\xf4\xf5\xf6\xf7\xf8\xf9\xfa",
};
pub(super) const CHROMA_AC: Table = Table {
    lengths: [0, 2, 1, 2, 4, 4, 3, 4, 7, 5, 4, 4, 0, 1, 2, 119],
    symbols: b"\x00\x01\x02\x03\x11\x04\x05\x21\x31\x06\x12\x41\x51\x07\x61\x71\x13\x22\x32\x81\x08\x14\x42\x91\xa1\xb1\xc1\
        \x09\x23\x33\x52\xf0\x15\x62\x72\xd1\x0a\x16\x24\x34\xe1\x25\xf1\x17\x18\x19\x1a\x26\x27\x28\x29\x2a\x35\x36\
        \x37\x38\x39\x3a\x43\x44\x45\x46\x47\x48\x49\x4a\x53\x54\x55\x56\x57\x58\x59\x5a\x63\x64\x65\x66\x67\x68\x69\
        \x6a\x73\x74\x75\x76\x77\x78\x79\x7a\x82\x83\x84\x85\x86\x87\x88\x89\x8a\x92\x93\x94\x95\x96\x97\x98\x99\x9a\
        \xa2\xa3\xa4\xa5\xa6\xa7\xa8\xa9\xaa\xb2\xb3\xb4\xb5\xb6\xb7\xb8\xb9\xba\xc2\xc3\xc4\xc5\xc6\xc7\xc8\xc9\xca\
        \xd2\xd3\xd4\xd5\xd6\xd7\xd8\xd9\xda\xe2\xe3\xe4\xe5\xe6\xe7\xe8\xe9\xea\xf2\xf3\xf4\xf5\xf6\xf7\xf8\xf9\xfa",
};

impl Table {
    /// Codes of each length count on from those before (T.81, annex C).
    pub(super) fn codes(&self) -> Codes {
        let mut codes = [(0, 0); 256];
        let mut symbols = self.symbols.iter();
        let mut code = 0;
        for (bits, &count) in (1..).zip(&self.lengths) {
            for &symbol in symbols.by_ref().take(usize::from(count)) {
                codes[usize::from(symbol)] = (code, bits);
                code += 1;
            }
            code <<= 1;
        }
        codes
    }
}

/// Bits on their way into a file.
#[derive(Default)]
pub(super) struct Bits {
    pub(super) file: Vec<u8>,
    waiting: u32,
    count: u8,
}

impl Bits {
    fn push(&mut self, bits: u16, count: u8) {
        self.count += count;
        self.waiting = self.waiting << count | u32::from(bits);
        while self.count >= 8 {
            self.count -= 8;
            let byte = (self.waiting >> self.count) as u8;
            self.file.push(byte);
            if byte == 0xff {
                // Otherwise it would begin a marker.
                self.file.push(0);
            }
        }
    }

    /// Fills the last byte with ones.
    pub(super) fn finish(mut self) -> Vec<u8> {
        self.push(0x7f, 7);
        self.file
    }

    /// The coefficients of a block in zigzag order; the first as its difference from the block before.
    pub(super) fn push_block(&mut self, block: &[i32; 64], before: i32, dc: &Codes, ac: &Codes) {
        const SIXTEEN_ZEROS: u8 = 0xf0;
        const END: u8 = 0;
        self.push_value(0, block[0] - before, dc);
        let mut zeros = 0;
        for &value in &block[1..] {
            if value == 0 {
                zeros += 1;
                continue;
            }
            while zeros > 15 {
                self.push_symbol(SIXTEEN_ZEROS, ac);
                zeros -= 16;
            }
            self.push_value(zeros, value, ac);
            zeros = 0;
        }
        if zeros > 0 {
            self.push_symbol(END, ac);
        }
    }

    fn push_symbol(&mut self, symbol: u8, codes: &Codes) {
        let (code, bits) = codes[usize::from(symbol)];
        self.push(code, bits);
    }

    /// A value behind so many zeros: its bits, then the value; negative ones less 1.
    fn push_value(&mut self, zeros: u8, value: i32, codes: &Codes) {
        let bits = 32 - value.unsigned_abs().leading_zeros();
        self.push_symbol(zeros << 4 | bits as u8, codes);
        let kept = (value - i32::from(value < 0)) & ((1 << bits) - 1);
        self.push(kept as u16, bits as u8);
    }
}
