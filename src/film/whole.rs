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

/// Removes the temporary files that are being filled, for a program about to end at once; no file
/// takes its name any more while the result is kept.
#[must_use]
pub fn abandon() -> impl Sized {
    let unfinished = unfinished();
    for path in unfinished.iter() {
        // Nobody is left to be told of a file that cannot be removed.
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
/// [`Error::Directory`] when the directory is missing or takes no new file, [`Error::Target`] when
/// `path` must not be replaced (a directory, a read-only file), [`Error::Write`] for what fails
/// later, such as a full disk; and whatever `fill` returns.
pub fn write(path: &Path, fill: impl FnOnce(&mut File) -> Result<(), Error>) -> Result<(), Error> {
    match target(path)? {
        Target::File(target, permissions) => replace(path, &target, permissions, fill),
        Target::Stream => feed(path, fill),
    }
}

/// Checks that [`write()`] can create or replace `path`, without touching what is there.
///
/// # Errors
/// As [`write()`]; a full disk is found only when there is content to be written.
pub fn probe(path: &Path) -> Result<(), Error> {
    match target(path)? {
        Target::File(target, _) => temporary(path, &target).map(drop),
        Target::Stream => Ok(()),
    }
}

/// Fills a temporary file and lets it take the target's name.
fn replace(
    path: &Path,
    target: &Path,
    permissions: Option<Permissions>,
    fill: impl FnOnce(&mut File) -> Result<(), Error>,
) -> Result<(), Error> {
    let mut temporary = temporary(path, target)?;
    let own = temporary.path().to_owned();
    unfinished().push(own.clone());
    let filled = fill_and_keep(path, &mut temporary, permissions, fill);
    let mut list = unfinished();
    list.retain(|path| *path != own);
    filled?;
    let persisted = temporary.persist(target);
    drop(list);
    persisted.map_err(|persist| refused(path, persist.error))?;
    sync_directory(directory(target));
    Ok(())
}

/// Fills a temporary file and brings it to the disk.
fn fill_and_keep(
    path: &Path,
    temporary: &mut NamedTempFile,
    permissions: Option<Permissions>,
    fill: impl FnOnce(&mut File) -> Result<(), Error>,
) -> Result<(), Error> {
    let failed = |source| refused(path, source);
    fill(temporary.as_file_mut())?;
    if let Some(permissions) = permissions {
        temporary
            .as_file()
            .set_permissions(permissions)
            .map_err(failed)?;
    }
    temporary.as_file().sync_all().map_err(failed)
}

/// Fills a nameless temporary file and copies it to a device or pipe.
fn feed(path: &Path, fill: impl FnOnce(&mut File) -> Result<(), Error>) -> Result<(), Error> {
    let failed = |source| refused(path, source);
    let mut content = tempfile::tempfile().map_err(failed)?;
    fill(&mut content)?;
    content.rewind().map_err(failed)?;
    let mut stream = OpenOptions::new().write(true).open(path).map_err(failed)?;
    io::copy(&mut content, &mut stream).map_err(failed)?;
    Ok(())
}

/// Looks at what stands at `path`.
fn target(path: &Path) -> Result<Target, Error> {
    let forbidden = |reason| Error::Target {
        path: path.to_owned(),
        reason,
    };
    match fs::metadata(path) {
        Ok(found) if found.is_dir() => Err(forbidden("it is a directory")),
        Ok(found) if found.is_file() && found.permissions().readonly() => {
            Err(forbidden("the file that is there is read-only"))
        }
        Ok(found) if found.is_file() => {
            let target = path
                .canonicalize()
                .map_err(|source| refused(path, source))?;
            Ok(Target::File(target, Some(found.permissions())))
        }
        Ok(found) if is_stream(&found) => Ok(Target::Stream),
        Ok(_) => Err(forbidden("it is not a file")),
        Err(source) if source.kind() != io::ErrorKind::NotFound => Err(refused(path, source)),
        Err(_) if path.file_name().is_none() => Err(forbidden("it has no file name")),
        Err(_) if fs::symlink_metadata(path).is_ok() => {
            Err(forbidden("it is a symbolic link to nothing"))
        }
        Err(_) => Ok(Target::File(path.to_owned(), None)),
    }
}

/// An empty temporary file beside `target`.
fn temporary(path: &Path, target: &Path) -> Result<NamedTempFile, Error> {
    let directory = directory(target);
    let mut builder = tempfile::Builder::new();
    builder.prefix(".etalon-").suffix(".part");
    let usual = usual_permissions();
    if let Some(permissions) = usual {
        builder.permissions(permissions);
    }
    builder
        .tempfile_in(directory)
        .map_err(|source| Error::Directory {
            path: path.to_owned(),
            directory: directory.to_owned(),
            source: bare(source),
        })
}

/// What the operating system said, without the name of the temporary file around it.
fn bare(error: io::Error) -> io::Error {
    error.raw_os_error().map_or_else(
        || io::Error::from(error.kind()),
        io::Error::from_raw_os_error,
    )
}

/// The directory a file lies in.
fn directory(target: &Path) -> &Path {
    match target.parent() {
        Some(parent) if !parent.as_os_str().is_empty() => parent,
        _ => Path::new("."),
    }
}

/// Names the path that could not be written.
fn refused(path: &Path, source: io::Error) -> Error {
    Error::Write {
        path: path.to_owned(),
        source,
    }
}

/// The permissions every new file asks for; the system takes the umask off. (Temporary files
/// are private otherwise.)
#[cfg(unix)]
fn usual_permissions() -> Option<Permissions> {
    use std::os::unix::fs::PermissionsExt;
    Some(Permissions::from_mode(0o666))
}

#[cfg(not(unix))]
fn usual_permissions() -> Option<Permissions> {
    None
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

/// Makes the rename itself durable. The file is complete under its name already, and not every
/// file system lets a directory be synchronised, so a failure here is none.
fn sync_directory(directory: &Path) {
    let _ = File::open(directory).and_then(|directory| directory.sync_all());
}
