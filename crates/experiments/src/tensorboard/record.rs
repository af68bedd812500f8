//! The framing of TensorFlow's record files.

/// One record as it stands in a file: its length as 8 bytes and their checksum, the data and theirs; little-endian.
///
/// Checksums are CRC-32C, rotated by 15 bits and shifted by a constant, as in TensorFlow's `record_writer.cc`.
pub(super) fn framed(data: &[u8]) -> Vec<u8> {
    let length = (data.len() as u64).to_le_bytes();
    [&length[..], &masked_crc(&length).to_le_bytes(), data, &masked_crc(data).to_le_bytes()].concat()
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
}
