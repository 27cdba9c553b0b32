//! Decompression of gzip and zstd files, recognised by their first bytes.

use std::io::Read;
use std::path::Path;

use crate::io::read_error::ReadError;

/// The bytes of a file, decompressed if they are of gzip or zstd.
pub(super) fn decompressed(path: &Path, bytes: Vec<u8>) -> Result<Vec<u8>, ReadError> {
    let mut text = Vec::new();
    let read = match bytes[..] {
        [0x1f, 0x8b, ..] => flate2::read::MultiGzDecoder::new(&bytes[..]).read_to_end(&mut text),
        [0x28, 0xb5, 0x2f, 0xfd, ..] | [0x50..=0x5f, 0x2a, 0x4d, 0x18, ..] => zstd_frames(&bytes, &mut text),
        _ => return Ok(bytes),
    };
    match read {
        Ok(_) => Ok(text),
        Err(source) => Err(ReadError::Compressed { path: path.into(), source }),
    }
}

/// All frames of zstd, without the skippable ones: a number from 0x184D2A50 to 0x184D2A5F, the length of the content, the content (RFC 8878,
/// section 3.1.2). `pzstd` and seekable archives have such frames.
fn zstd_frames(mut bytes: &[u8], text: &mut Vec<u8>) -> std::io::Result<usize> {
    while !bytes.is_empty() {
        if let [0x50..=0x5f, 0x2a, 0x4d, 0x18, a, b, c, d, rest @ ..] = bytes {
            let length = u32::from_le_bytes([*a, *b, *c, *d]) as usize;
            bytes = rest.get(length..).ok_or_else(|| std::io::Error::other("a skippable frame is cut"))?;
            continue;
        }
        let mut frame = ruzstd::decoding::StreamingDecoder::new(&mut bytes).map_err(std::io::Error::other)?;
        frame.read_to_end(text)?;
        let (written, found) = (frame.decoder.get_checksum_from_data(), frame.decoder.get_calculated_checksum());
        if written.is_some() && written != found {
            return Err(std::io::Error::other("its checksum differs from the content"));
        }
    }
    Ok(text.len())
}
