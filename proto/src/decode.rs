//! From bytes to a checked message: the only way in.

use prost::Message;

use crate::check::{MessageError, length};
use crate::limits;

/// Reads a message. Its fields are counted before anything is made of them: two bytes of an empty artifact would
/// become a hundred in memory.
///
/// # Errors
/// [`MessageError`]: the bytes are no such message, or a field holds what it must not.
pub fn decode<W, M>(bytes: &[u8]) -> Result<M, MessageError>
where
    W: Message + Default,
    M: TryFrom<W, Error = MessageError>,
{
    let fields = count_fields(bytes).ok_or(MessageError::Cut)?;
    length("message", fields, limits::MESSAGE_FIELDS, "fields")?;
    let wire = W::decode(bytes).map_err(|error| MessageError::Wire(error.to_string()))?;
    M::try_from(wire)
}

/// Fields of the outermost level; none: the bytes end inside of one.
fn count_fields(mut bytes: &[u8]) -> Option<usize> {
    let mut fields = 0;
    while !bytes.is_empty() {
        let key = varint(&mut bytes)?;
        let value = match key & 7 {
            0 => varint(&mut bytes).map(|_| 0),
            1 => Some(8),
            2 => varint(&mut bytes),
            // The form of a group, which no message of ours has: prost finds its own words for it.
            3 | 4 => Some(0),
            5 => Some(4),
            _ => None,
        }?;
        bytes = bytes.get(usize::try_from(value).ok()?..)?;
        fields += 1;
    }
    Some(fields)
}

fn varint(bytes: &mut &[u8]) -> Option<u64> {
    let mut value = 0_u64;
    for shift in (0..64).step_by(7) {
        let (&byte, rest) = bytes.split_first()?;
        *bytes = rest;
        value |= u64::from(byte & 0x7f) << shift;
        if byte & 0x80 == 0 {
            return Some(value);
        }
    }
    None
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::message::{BeatOf, PutArtifacts};
    use crate::wire::{BeatRequest, PutArtifactsRequest};

    #[test]
    fn fields_are_counted_before_they_are_decoded() {
        // Field 5, length 0: an artifact without anything.
        let many = [0x2a, 0].repeat(limits::MESSAGE_FIELDS + 1);
        let error = decode::<PutArtifactsRequest, PutArtifacts>(&many).unwrap_err();
        assert_eq!(error.to_string(), "`message` has 8193 fields, the limit is 8192");
        let beat = BeatRequest {
            worker_id: "wrk_1".to_owned(),
            tokens: vec![1, u64::MAX],
        };
        let read: BeatOf = decode::<BeatRequest, BeatOf>(&beat.encode_to_vec()).unwrap();
        assert_eq!(read.tokens, [1, u64::MAX]);
    }

    #[test]
    fn bytes_that_end_early_or_have_another_form_are_told_apart_from_wrong_values() {
        for cut in [&[0x0a, 5, b'x'][..], &[0x80], &[0xff; 11], &[0x0f], &[0x09, 1]] {
            assert_eq!(
                decode::<BeatRequest, BeatOf>(cut).unwrap_err(),
                MessageError::Cut,
                "{cut:?}"
            );
        }
        // `worker_id` as a number.
        assert!(matches!(
            decode::<BeatRequest, BeatOf>(&[0x08, 1]),
            Err(MessageError::Wire(_))
        ));
    }
}
