//! As much of the protobuf wire format as an ONNX file needs.

/// Bytes under a field number.
pub(crate) fn bytes(out: &mut Vec<u8>, field: u64, bytes: &[u8]) {
    varint(out, field << 3 | 2);
    varint(out, bytes.len() as u64);
    out.extend_from_slice(bytes);
}

/// An integer under a field number; negative ones in two's complement of 64 bits.
pub(crate) fn integer(out: &mut Vec<u8>, field: u64, value: i64) {
    varint(out, field << 3);
    varint(out, value as u64);
}

fn varint(out: &mut Vec<u8>, mut value: u64) {
    while value >= 0x80 {
        out.push(value as u8 | 0x80);
        value >>= 7;
    }
    out.push(value as u8);
}

/// What stands under a field number.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Value<'a> {
    Integer(u64),
    Bytes(&'a [u8]),
    /// Four or eight bytes of fixed length.
    Fixed,
}

/// The fields of a message in their order; stops with `None` inside at the first byte that is no protobuf.
pub(crate) fn fields(message: &[u8]) -> impl Iterator<Item = Option<(u64, Value<'_>)>> {
    let mut rest = Some(message);
    std::iter::from_fn(move || {
        let now = rest.filter(|bytes| !bytes.is_empty())?;
        let parsed = field(now);
        rest = parsed.map(|(_, after)| after);
        Some(parsed.map(|(field, _)| field))
    })
}

fn field(message: &[u8]) -> Option<((u64, Value<'_>), &[u8])> {
    let (key, rest) = read_varint(message)?;
    let (value, rest) = match key & 7 {
        0 => {
            let (value, rest) = read_varint(rest)?;
            (Value::Integer(value), rest)
        }
        1 => (Value::Fixed, rest.get(8..)?),
        2 => {
            let (length, rest) = read_varint(rest)?;
            let (bytes, rest) = rest.split_at_checked(usize::try_from(length).ok()?)?;
            (Value::Bytes(bytes), rest)
        }
        5 => (Value::Fixed, rest.get(4..)?),
        _ => return None,
    };
    Some(((key >> 3, value), rest))
}

fn read_varint(bytes: &[u8]) -> Option<(u64, &[u8])> {
    let mut value = 0;
    for (index, &byte) in bytes.iter().take(10).enumerate() {
        value |= u64::from(byte & 0x7f) << (7 * index);
        if byte < 0x80 {
            return Some((value, &bytes[index + 1..]));
        }
    }
    None
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
            (1, Value::Integer(300)),
            (200, Value::Bytes(b"abc")),
            (3, Value::Integer(u64::MAX)),
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
