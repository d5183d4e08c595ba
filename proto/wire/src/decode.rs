//! Decoding and checking of received messages.

use crate::check::Checked;
use crate::error::MessageError;
use crate::{limits, rules};

/// Decodes a message and checks it. Fields are counted before decoding, because an empty artifact takes two bytes on
/// the wire and about a hundred in memory.
///
/// # Errors
/// [`MessageError`] if the bytes are not such a message or a field is invalid.
pub fn decode<M: Checked>(bytes: &[u8]) -> Result<M, MessageError> {
    let fields = count_fields(bytes).ok_or(MessageError::Cut)?;
    rules::check_length("message", fields, limits::MESSAGE_FIELDS, "fields")?;
    let message = M::decode(bytes).map_err(|error| MessageError::Wire(error.to_string()))?;
    message.check()?;
    Ok(message)
}

/// Counts the fields of the outermost level; `None` if the bytes end inside one.
fn count_fields(mut bytes: &[u8]) -> Option<usize> {
    let mut fields = 0;
    while !bytes.is_empty() {
        let key = read_varint(&mut bytes)?;
        let value = match key & 7 {
            0 => read_varint(&mut bytes).map(|_| 0),
            1 => Some(8),
            2 => read_varint(&mut bytes),
            // A group: this protocol has none, and prost reports it.
            3 | 4 => Some(0),
            5 => Some(4),
            _ => None,
        }?;
        bytes = bytes.get(usize::try_from(value).ok()?..)?;
        fields += 1;
    }
    Some(fields)
}

fn read_varint(bytes: &mut &[u8]) -> Option<u64> {
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
    use prost::Message;

    use super::*;
    use crate::messages::{BeatRequest, PutArtifactsRequest};

    #[test]
    fn fields_are_counted_before_they_are_decoded() {
        // Field 2, length 0: an empty artifact.
        let many = [0x12, 0].repeat(limits::MESSAGE_FIELDS + 1);
        let error = decode::<PutArtifactsRequest>(&many).unwrap_err();
        assert_eq!(
            error.to_string(),
            "`message` has 8193 fields; must be at most 8192"
        );
        let beat = BeatRequest {
            worker_id: "wrk_1".to_owned(),
            tokens: vec![1, u64::MAX],
            wait_ms: 7,
        };
        assert_eq!(decode(&beat.encode_to_vec()), Ok(beat));
    }

    #[test]
    fn truncated_and_malformed_bytes_differ_from_wrong_values() {
        for cut in [&[0x0a, 5, b'x'][..], &[0x80], &[0xff; 11], &[0x0f], &[0x09, 1]] {
            assert_eq!(
                decode::<BeatRequest>(cut).unwrap_err(),
                MessageError::Cut,
                "{cut:?}"
            );
        }
        // `worker_id` as a number.
        assert!(matches!(
            decode::<BeatRequest>(&[0x08, 1]),
            Err(MessageError::Wire(_))
        ));
    }
}
