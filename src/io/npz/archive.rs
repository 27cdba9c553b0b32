//! [`members`] and [`Archive`]: the files inside a zip archive, as NumPy writes them.
//!
//! Members are stored, or compressed by DEFLATE. Each has a CRC-32, which is checked. Archives above 4 GiB (zip64) and encrypted ones are
//! refused. DEFLATE and CRC-32 are those of `flate2`, which the reader of gzip needs anyway; a crate for zip would make a first build
//! longer (`benches/NOTES.md`).
//!
//! # Source
//! PKWARE (2022), APPNOTE.TXT, .ZIP File Format Specification 6.3.10, sections 4.3 and 4.4.

use std::io::{self, Read, Write};

use crate::io::npz::error::ArchiveError;

/// Signatures of a member, of its entry in the directory, and of the end of the directory.
pub(super) const MEMBER: [u8; 4] = *b"PK\x03\x04";
const ENTRY: [u8; 4] = *b"PK\x01\x02";
pub(super) const END: [u8; 4] = *b"PK\x05\x06";

/// Lengths of these records without names, comments and extra fields \[bytes\].
const MEMBER_LENGTH: usize = 30;
const ENTRY_LENGTH: usize = 46;
const END_LENGTH: usize = 22;

/// Longest comment of an archive \[bytes\].
const COMMENT_LIMIT: usize = 0xffff;

/// Methods of compression.
const STORED: u16 = 0;
const DEFLATED: u16 = 8;

/// The date 1980-01-01, the first that the format has: the same content gives the same bytes.
const DATE: u16 = 0x21;

fn two(bytes: &[u8], at: usize) -> Option<u16> {
    Some(u16::from_le_bytes(bytes.get(at..at + 2)?.try_into().ok()?))
}

fn four(bytes: &[u8], at: usize) -> Option<usize> {
    usize::try_from(u32::from_le_bytes(bytes.get(at..at + 4)?.try_into().ok()?)).ok()
}

fn checksum(content: &[u8]) -> u32 {
    let mut crc = flate2::Crc::new();
    crc.update(content);
    crc.sum()
}

/// The names and contents of all members.
pub(super) fn members(bytes: &[u8]) -> Result<Vec<(String, Vec<u8>)>, ArchiveError> {
    let damaged = |what| ArchiveError::Damaged { what };
    let first = bytes.len().saturating_sub(END_LENGTH + COMMENT_LIMIT);
    let mut ends = (first..=bytes.len().saturating_sub(END_LENGTH)).rev();
    let end =
        ends.find(|&at| bytes[at..].starts_with(&END)).ok_or_else(|| damaged("it has no directory at its end"))?;
    let (count, start) = (two(bytes, end + 10).unwrap_or(0), four(bytes, end + 16).unwrap_or(0));
    if count == u16::MAX || start == u32::MAX as usize {
        return Err(ArchiveError::Zip64);
    }
    let (mut at, mut all) = (start, Vec::new());
    for _ in 0..count {
        let (name, content, length) = member(bytes, at)?;
        all.push((name, content));
        at += length;
    }
    Ok(all)
}

/// The member whose entry is at this place, and the length of the entry.
fn member(bytes: &[u8], at: usize) -> Result<(String, Vec<u8>, usize), ArchiveError> {
    let damaged = |what| ArchiveError::Damaged { what };
    let cut = || damaged("its directory is cut");
    let entry = bytes.get(at..).filter(|entry| entry.starts_with(&ENTRY)).ok_or_else(cut)?;
    let short = |place| two(entry, place).map(usize::from).ok_or_else(cut);
    let long = |place| four(entry, place).ok_or_else(cut);
    let (flags, method) = (short(8)?, short(10)?);
    let (sum, packed, size, place) = (long(16)?, long(20)?, long(24)?, long(42)?);
    let name_end = ENTRY_LENGTH + short(28)?;
    let name = entry.get(ENTRY_LENGTH..name_end).ok_or_else(cut)?;
    let name = String::from_utf8_lossy(name).into_owned();
    if [packed, size, place].contains(&(u32::MAX as usize)) {
        return Err(ArchiveError::Zip64);
    }
    if flags & 1 != 0 {
        return Err(ArchiveError::Encrypted { name });
    }
    // The member repeats its name, with an extra field of its own.
    let header = bytes.get(place..).filter(|header| header.starts_with(&MEMBER)).ok_or_else(cut)?;
    let skipped = |from| two(header, from).map(usize::from).ok_or_else(cut);
    let start = MEMBER_LENGTH + skipped(26)? + skipped(28)?;
    let stored = header.get(start..start.saturating_add(packed)).ok_or_else(|| damaged("a member is cut"))?;
    let content = match u16::try_from(method) {
        Ok(STORED) => stored.to_vec(),
        Ok(DEFLATED) => {
            let mut content = Vec::new();
            // One byte more than announced shows that the announcement is wrong.
            let mut decoder = flate2::read::DeflateDecoder::new(stored).take(size as u64 + 1);
            decoder.read_to_end(&mut content).map_err(|_| damaged("a member cannot be decompressed"))?;
            content
        }
        _ => return Err(ArchiveError::Method { name, method }),
    };
    if content.len() != size || checksum(&content) as usize != sum {
        return Err(damaged("the checksum or the size of a member differs from its content"));
    }
    Ok((name, content, name_end + short(30)? + short(32)?))
}

/// An archive that is being written; its members are stored.
pub(super) struct Archive<'a, W> {
    writer: &'a mut W,
    written: u64,
    entries: Vec<Vec<u8>>,
}

impl<'a, W: Write> Archive<'a, W> {
    pub fn new(writer: &'a mut W) -> Self {
        Archive { writer, written: 0, entries: Vec::new() }
    }

    /// Adds a member.
    pub fn add(&mut self, name: &str, content: &[u8]) -> io::Result<()> {
        let place = limited(self.written)?;
        let (size, name_length) = (limited(content.len() as u64)?, u16::try_from(name.len()).map_err(too_large)?);
        // Version 2.0 of the format, no flags, stored, no time, the date.
        let mut known: Vec<u8> = [20, 0, STORED, 0, DATE].into_iter().flat_map(u16::to_le_bytes).collect();
        known.extend([checksum(content), size, size].into_iter().flat_map(u32::to_le_bytes));
        known.extend([name_length, 0].into_iter().flat_map(u16::to_le_bytes));
        let header = [&MEMBER[..], &known, name.as_bytes()].concat();
        self.writer.write_all(&header)?;
        self.writer.write_all(content)?;
        self.written += (header.len() + content.len()) as u64;
        // No comment, disk 0, no attributes.
        let rest = [&[0; 10][..], &place.to_le_bytes()].concat();
        self.entries.push([&ENTRY[..], &20_u16.to_le_bytes(), &known, &rest, name.as_bytes()].concat());
        Ok(())
    }

    /// Writes the directory.
    pub fn finish(self) -> io::Result<()> {
        let (start, count) = (limited(self.written)?, u16::try_from(self.entries.len()).map_err(too_large)?);
        let directory = self.entries.concat();
        self.writer.write_all(&directory)?;
        let length = limited(directory.len() as u64)?;
        limited(self.written + u64::from(length))?;
        let counts: Vec<u8> = [0, 0, count, count].into_iter().flat_map(u16::to_le_bytes).collect();
        let places: Vec<u8> = [length, start].into_iter().flat_map(u32::to_le_bytes).collect();
        self.writer.write_all(&[&END[..], &counts, &places, &[0, 0]].concat())
    }
}

/// A size that the format holds without zip64.
fn limited(size: u64) -> io::Result<u32> {
    u32::try_from(size).ok().filter(|&size| size < u32::MAX).ok_or_else(|| too_large(()))
}

fn too_large<E>(_: E) -> io::Error {
    io::Error::new(io::ErrorKind::FileTooLarge, "a NumPy archive holds at most 4 GiB here; write extended XYZ")
}
