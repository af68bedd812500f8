//! The framing of TensorFlow's record files.

/// One record as it stands in a file: its length as 8 bytes and their checksum, the data and theirs; little-endian.
///
/// Checksums are CRC-32C, rotated by 15 bits and shifted by a constant, as in TensorFlow's `record_writer.cc`.
pub(super) fn framed(data: &[u8]) -> Vec<u8> {
    let length = (data.len() as u64).to_le_bytes();
    [&length[..], &masked_crc(&length).to_le_bytes(), data, &masked_crc(data).to_le_bytes()].concat()
}

/// The data of all records of a file; none if it is cut off or a checksum is wrong.
pub(super) fn unframed(mut file: &[u8]) -> Option<Vec<&[u8]>> {
    let mut records = Vec::new();
    while !file.is_empty() {
        let (length, rest) = file.split_first_chunk::<8>()?;
        let length = usize::try_from(u64::from_le_bytes(*length)).ok()?;
        let data = rest.get(4..)?.get(..length)?;
        let frame = framed(data);
        file = file.strip_prefix(&frame[..])?;
        records.push(data);
    }
    Some(records)
}

fn masked_crc(bytes: &[u8]) -> u32 {
    crc32c::crc32c(bytes).rotate_right(15).wrapping_add(0xa282_ead8)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_checksum_is_castagnolis() {
        // RFC 3720, B.4: 32 bytes of zeros, and the usual check value.
        assert_eq!(crc32c::crc32c(&[0; 32]), 0x8a91_36aa);
        assert_eq!(crc32c::crc32c(b"123456789"), 0xe306_9283);
        assert_eq!(masked_crc(&[0; 32]), 0x0fd7_fffa);
    }

    #[test]
    fn a_frame_has_sixteen_bytes_more_than_its_data() {
        let frame = framed(b"abc");
        assert_eq!(frame.len(), 8 + 4 + 3 + 4);
        assert_eq!((&frame[..8], &frame[12..15]), (&[3, 0, 0, 0, 0, 0, 0, 0][..], &b"abc"[..]));
    }

    #[test]
    fn what_is_framed_is_unframed_and_damage_is_seen() {
        let records: [&[u8]; 3] = [b"abc", b"", &[7; 300]];
        let file = records.map(framed).concat();
        assert_eq!(unframed(&file).unwrap(), records);
        assert!(unframed(&[]).unwrap().is_empty());
        let whole = [0, 19, 19 + 16, file.len()];
        assert!((0..=file.len()).all(|cut| unframed(&file[..cut]).is_some() == whole.contains(&cut)));
        for at in 0..file.len() {
            let mut damaged = file.clone();
            damaged[at] ^= 1;
            assert_eq!(unframed(&damaged), None, "byte {at}");
        }
        assert_eq!(unframed(&[u8::MAX; 16]), None, "a length beyond all files");
    }
}
