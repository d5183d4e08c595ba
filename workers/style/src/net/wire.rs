//! The subset of the protobuf wire format used by ONNX files.

use prost::encoding::{WireType, decode_key, decode_varint, encode_key, encode_varint};

/// Writes bytes under a field number.
pub(crate) fn bytes(out: &mut Vec<u8>, field: u32, bytes: &[u8]) {
    encode_key(field, WireType::LengthDelimited, out);
    encode_varint(bytes.len() as u64, out);
    out.extend_from_slice(bytes);
}

/// Writes an integer under a field number; negative ones in 64-bit two's complement.
pub(crate) fn integer(out: &mut Vec<u8>, field: u32, value: i64) {
    encode_key(field, WireType::Varint, out);
    encode_varint(value as u64, out);
}

/// The value of a field.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum WireValue<'a> {
    Integer(u64),
    Bytes(&'a [u8]),
    /// Four or eight bytes of fixed length.
    Fixed,
}

/// The fields of a message in order; ends with `None` at the first invalid byte.
pub(crate) fn fields(message: &[u8]) -> impl Iterator<Item = Option<(u32, WireValue<'_>)>> {
    let mut rest = Some(message);
    std::iter::from_fn(move || {
        let now = rest.filter(|bytes| !bytes.is_empty())?;
        let parsed = field(now);
        rest = parsed.map(|(_, after)| after);
        Some(parsed.map(|(field, _)| field))
    })
}

/// The messages and texts under a field number.
pub(crate) fn messages(message: &[u8], number: u32) -> impl Iterator<Item = &[u8]> {
    fields(message).filter_map(move |field| match field? {
        (found, WireValue::Bytes(bytes)) if found == number => Some(bytes),
        _ => None,
    })
}

fn field(mut message: &[u8]) -> Option<((u32, WireValue<'_>), &[u8])> {
    let (number, kind) = decode_key(&mut message).ok()?;
    let length = match kind {
        WireType::Varint => {
            let value = decode_varint(&mut message).ok()?;
            return Some(((number, WireValue::Integer(value)), message));
        }
        WireType::LengthDelimited => usize::try_from(decode_varint(&mut message).ok()?).ok()?,
        WireType::ThirtyTwoBit => 4,
        WireType::SixtyFourBit => 8,
        WireType::StartGroup | WireType::EndGroup => return None,
    };
    let (bytes, rest) = message.split_at_checked(length)?;
    let value = match kind {
        WireType::LengthDelimited => WireValue::Bytes(bytes),
        _ => WireValue::Fixed,
    };
    Some(((number, value), rest))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_written_is_read_again() {
        let mut message = Vec::new();
        integer(&mut message, 1, 300);
        bytes(&mut message, 200, b"abc");
        integer(&mut message, 3, -1);
        let read: Option<Vec<_>> = fields(&message).collect();
        let expected = [
            (1, WireValue::Integer(300)),
            (200, WireValue::Bytes(b"abc")),
            (3, WireValue::Integer(u64::MAX)),
        ];
        assert_eq!(read.unwrap(), expected);
    }

    #[test]
    fn a_message_that_is_cut_anywhere_ends_without_a_panic() {
        let mut message = Vec::new();
        bytes(&mut message, 7, &[1; 200]);
        for end in 1..message.len() {
            assert!(fields(&message[..end]).any(|field| field.is_none()), "{end}");
        }
        assert_eq!(fields(&[0xff; 30]).next(), Some(None));
        assert_eq!(fields(&[0x0b]).next(), Some(None), "groups are not known");
    }
}
