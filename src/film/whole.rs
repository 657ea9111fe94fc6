//! Files that appear whole or not at all.
//!
//! The content goes to a temporary file in the target's own directory (only there is a rename
//! atomic), is brought to the disk, and takes the target's name at once. Whatever fails before
//! leaves an existing file as it was, and nothing else behind; a program that has to end while it
//! writes calls [`abandon`] first, and only a process killed leaves its `.etalon-….part`.

use std::fs::{self, File, Metadata, OpenOptions, Permissions};
use std::io::{self, Seek};
use std::path::{Path, PathBuf};
use std::sync::{Mutex, MutexGuard, PoisonError};

use tempfile::NamedTempFile;

use super::Error;

/// Temporary files that are being filled.
static UNFINISHED: Mutex<Vec<PathBuf>> = Mutex::new(Vec::new());

fn unfinished() -> MutexGuard<'static, Vec<PathBuf>> {
    // A list of paths is never half changed.
    UNFINISHED.lock().unwrap_or_else(PoisonError::into_inner)
}

/// Removes the temporary files that are being filled, for a program about to end at once; while
/// the result is kept, no temporary file takes the name of its target.
#[must_use]
pub fn abandon() -> impl Sized {
    let unfinished = unfinished();
    for path in unfinished.iter() {
        // The program ends: a file that cannot be removed is nobody's concern.
        let _ = fs::remove_file(path);
    }
    unfinished
}

/// Where the content will end up.
enum Target {
    /// A regular file, and the permissions of the one to be replaced.
    File(PathBuf, Option<Permissions>),
    /// A device or pipe, which cannot be replaced but takes the finished content.
    Stream,
}

/// Writes a file through `fill`, whole or not at all.
///
/// A symbolic link is followed; a replaced file keeps its permissions; a new one has those every
/// new file has. A device or pipe receives the content once it is complete.
///
/// # Errors
/// [`Error::Write`] when the directory is missing or takes no new file, when `path` must not be
/// replaced (a directory, a read-only file), for what fails later, such as a full disk, and for
/// whatever `fill` returns.
pub fn write(path: &Path, fill: impl FnOnce(&mut File) -> io::Result<()>) -> Result<(), Error> {
    let written = target(path).and_then(|target| match target {
        Target::File(target, permissions) => replace(&target, permissions, fill),
        Target::Stream => feed(path, fill),
    });
    written.map_err(|source| refused(path, source))
}

/// Checks that [`write()`] can create or replace `path`, without touching what is there.
///
/// # Errors
/// As [`write()`]; a full disk is found only when there is content to be written.
pub fn probe(path: &Path) -> Result<(), Error> {
    let probed = target(path).and_then(|target| match target {
        Target::File(target, _) => temporary(&target).map(drop),
        Target::Stream => Ok(()),
    });
    probed.map_err(|source| refused(path, source))
}

fn refused(path: &Path, source: io::Error) -> Error {
    let path = path.to_owned();
    Error::Write { path, source }
}

/// Fills a temporary file, brings it to the disk, and lets it take the target's name.
fn replace(
    target: &Path,
    permissions: Option<Permissions>,
    fill: impl FnOnce(&mut File) -> io::Result<()>,
) -> io::Result<()> {
    let mut temporary = temporary(target)?;
    let own = temporary.path().to_owned();
    unfinished().push(own.clone());
    let file = temporary.as_file_mut();
    let filled = fill(file)
        .and_then(|()| permissions.map_or(Ok(()), |permissions| file.set_permissions(permissions)))
        .and_then(|()| file.sync_all());
    let mut list = unfinished();
    list.retain(|path| *path != own);
    filled?;
    let persisted = temporary.persist(target);
    drop(list);
    persisted?;
    // This makes the rename itself durable. The file is complete under its name already, and not
    // every file system lets a directory be synchronised, so a failure here is none.
    let _ = File::open(directory(target)).and_then(|directory| directory.sync_all());
    Ok(())
}

/// Fills a nameless temporary file and copies it to a device or pipe.
fn feed(path: &Path, fill: impl FnOnce(&mut File) -> io::Result<()>) -> io::Result<()> {
    let mut content = tempfile::tempfile()?;
    fill(&mut content)?;
    content.rewind()?;
    let mut stream = OpenOptions::new().write(true).open(path)?;
    io::copy(&mut content, &mut stream).map(drop)
}

/// Looks at what stands at `path`.
fn target(path: &Path) -> io::Result<Target> {
    let forbidden = |reason| Err(io::Error::new(io::ErrorKind::InvalidInput, reason));
    match fs::metadata(path) {
        Ok(found) if found.is_dir() => forbidden("it is a directory"),
        Ok(found) if found.is_file() && found.permissions().readonly() => {
            forbidden("the file that is there is read-only")
        }
        Ok(found) if found.is_file() => Ok(Target::File(
            path.canonicalize()?,
            Some(found.permissions()),
        )),
        Ok(found) if is_stream(&found) => Ok(Target::Stream),
        Ok(_) => forbidden("it is not a file"),
        Err(source) if source.kind() != io::ErrorKind::NotFound => Err(source),
        Err(_) if path.file_name().is_none() => forbidden("it has no file name"),
        Err(_) if fs::symlink_metadata(path).is_ok() => {
            forbidden("it is a symbolic link to nothing")
        }
        Err(_) => Ok(Target::File(path.to_owned(), None)),
    }
}

/// An empty temporary file beside `target`.
fn temporary(target: &Path) -> io::Result<NamedTempFile> {
    let directory = directory(target);
    let mut builder = tempfile::Builder::new();
    builder.prefix(".etalon-").suffix(".part");
    // What every new file asks for, before the system takes the umask off: temporary files are
    // private otherwise.
    #[cfg(unix)]
    builder.permissions(std::os::unix::fs::PermissionsExt::from_mode(0o666));
    builder.tempfile_in(directory).map_err(|error| {
        // What the operating system said, without the name of the temporary file around it.
        let kind = error.kind();
        let bare = error
            .raw_os_error()
            .map_or_else(|| kind.into(), io::Error::from_raw_os_error);
        let place = directory.display();
        io::Error::new(
            kind,
            format!("no file can be created in the directory {place}: {bare}"),
        )
    })
}

/// The directory a file lies in.
fn directory(target: &Path) -> &Path {
    match target.parent() {
        Some(parent) if !parent.as_os_str().is_empty() => parent,
        _ => Path::new("."),
    }
}

#[cfg(unix)]
fn is_stream(found: &Metadata) -> bool {
    use std::os::unix::fs::FileTypeExt;
    found.file_type().is_char_device() || found.file_type().is_fifo()
}

#[cfg(not(unix))]
fn is_stream(_found: &Metadata) -> bool {
    false
}
