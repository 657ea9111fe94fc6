//! The attributes of an OpenEXR header in one fixed order.
//!
//! The order of attributes is free in the format, and the `exr` crate keeps custom ones in a
//! hash map with a random seed: the same picture would be other bytes in every run. Sorting them
//! by name keeps the header's length, so that no offset in the file changes.
//!
//! Layout (Kainz, Bogart et al., *OpenEXR File Layout*): magic number and version, 4 bytes each;
//! attributes as name and type, both ended by a zero byte, length in 4 bytes little-endian, and
//! value; the header ends with a zero byte in place of a name.

use std::io::{self, BufRead, BufReader, Read, Seek, SeekFrom, Write};

/// Bytes before the first attribute.
const PREAMBLE: u64 = 8;

/// Sorts the attributes of a single-part file in place, by the bytes of their names.
///
/// # Errors
/// When reading or writing fails, or when the file does not hold a complete header.
pub fn sort<F: Read + Write + Seek>(file: &mut F) -> io::Result<()> {
    file.seek(SeekFrom::Start(PREAMBLE))?;
    let mut attributes = Vec::new();
    let mut reader = BufReader::new(&mut *file);
    while let Some(attribute) = next(&mut reader)? {
        attributes.push(attribute);
    }
    attributes.sort();
    file.seek(SeekFrom::Start(PREAMBLE))?;
    file.write_all(&attributes.concat())
}

/// The bytes of the next attribute, or `None` at the end of the header. They begin with the
/// name and its zero byte, so that comparing them compares the names first.
fn next(reader: &mut impl BufRead) -> io::Result<Option<Vec<u8>>> {
    let mut bytes = Vec::new();
    if terminated(reader, &mut bytes)? == 1 {
        return Ok(None);
    }
    terminated(reader, &mut bytes)?;
    let mut length = [0; 4];
    reader.read_exact(&mut length)?;
    bytes.extend(length);
    let length = u64::from(u32::from_le_bytes(length));
    if reader.take(length).read_to_end(&mut bytes)? as u64 == length {
        Ok(Some(bytes))
    } else {
        Err(io::ErrorKind::UnexpectedEof.into())
    }
}

/// Appends bytes up to and with a zero byte; says how many.
fn terminated(reader: &mut impl BufRead, bytes: &mut Vec<u8>) -> io::Result<usize> {
    let count = reader.read_until(0, bytes)?;
    if bytes.last() == Some(&0) {
        Ok(count)
    } else {
        Err(io::ErrorKind::UnexpectedEof.into())
    }
}
