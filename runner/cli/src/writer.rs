//! Pictures are encoded on all processors, and written in order, while the next ones are rendered.

use candela::error::{Error, Result};
use candela::image_io;
use std::path::PathBuf;
use std::sync::mpsc::{self, Receiver, SyncSender};
use std::thread::{self, JoinHandle};

/// A file's name, and its bytes once they are there.
type Ordered = (PathBuf, Receiver<Result<Vec<u8>>>);

/// Writes pictures in the order in which they come. Of more than one a processor the next one waits, so that memory stays bounded.
/// Dropped, it writes what it has: whatever ends a sequence, its pictures up to there stay.
pub struct Writer {
    /// None once it takes no more.
    queue: Option<SyncSender<Ordered>>,
    writes: Option<JoinHandle<Result<()>>>,
}

impl Writer {
    pub fn new() -> Self {
        let (queue, ordered) = mpsc::sync_channel::<Ordered>(rayon::current_num_threads());
        let writes = thread::spawn(move || {
            for (path, bytes) in ordered {
                let bytes =
                    bytes.recv().map_err(|_| Error::Internal("a picture was not encoded".into()))??;
                image_io::replace(&path, &bytes)?;
            }
            Ok(())
        });
        Writer { queue: Some(queue), writes: Some(writes) }
    }

    /// `encode`d, the picture will be at `path`. Fails if one before it could not be written; no later one is then.
    pub fn push(
        &mut self,
        path: PathBuf,
        encode: impl FnOnce() -> Result<Vec<u8>> + Send + 'static,
    ) -> Result<()> {
        let (done, bytes) = mpsc::channel();
        rayon::spawn(move || {
            // Nobody waits for it once writing has failed.
            let _ = done.send(encode());
        });
        match &self.queue {
            Some(queue) if queue.send((path, bytes)).is_ok() => Ok(()),
            _ => self.finish(),
        }
    }

    /// Waits until all are written.
    pub fn finish(&mut self) -> Result<()> {
        self.queue = None;
        let Some(writes) = self.writes.take() else { return Ok(()) };
        writes.join().map_err(|_| Error::Internal("pictures are no longer written".into()))?
    }
}

impl Drop for Writer {
    fn drop(&mut self) {
        // Another error is on its way to the user.
        let _ = self.finish();
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::fs;
    use std::sync::atomic::{AtomicU32, Ordering};

    fn folder(name: &str) -> PathBuf {
        let folder = std::env::temp_dir().join(format!("candela-writer-{}-{name}", std::process::id()));
        fs::create_dir_all(&folder).unwrap();
        folder
    }

    /// However long each takes: a later one is never there before an earlier one, so that an interrupted sequence resumes.
    #[test]
    fn pictures_come_in_order() {
        let folder = folder("order");
        let mut writer = Writer::new();
        for i in 0..40u8 {
            writer
                .push(folder.join(format!("{i}")), move || {
                    let spins = u32::from((i % 7) * 40) * 1000;
                    Ok(vec![i; (0..spins).fold(3, |a: u32, b| a.wrapping_mul(31) ^ b) as usize % 5 + 1])
                })
                .unwrap();
            // From the last one down: what is written meanwhile comes before what was seen.
            let mut later = (0..40).rev().skip_while(|i| !folder.join(format!("{i}")).exists());
            assert!(later.all(|i| folder.join(format!("{i}")).exists()));
        }
        writer.finish().unwrap();
        for i in 0..40u8 {
            assert_eq!(fs::read(folder.join(format!("{i}"))).unwrap()[0], i);
        }
        fs::remove_dir_all(folder).unwrap();
    }

    #[test]
    fn what_was_pushed_is_written_however_it_ends() {
        let folder = folder("dropped");
        let mut writer = Writer::new();
        (0..5u8)
            .for_each(|i| writer.push(folder.join(format!("{i}")), move || Ok(vec![i; 1 << 20])).unwrap());
        drop(writer);
        assert!((0..5).all(|i| fs::metadata(folder.join(format!("{i}"))).unwrap().len() == 1 << 20));
        assert_eq!(fs::read_dir(&folder).unwrap().count(), 5, "nothing half written");
        fs::remove_dir_all(folder).unwrap();
    }

    #[test]
    fn the_first_error_ends_it() {
        let folder = folder("error");
        let mut writer = Writer::new();
        let made = std::sync::Arc::new(AtomicU32::new(0));
        let mut pushed = Ok(());
        for i in 0..1000u32 {
            let made = made.clone();
            pushed = writer.push(folder.join(format!("{i}")), move || {
                made.fetch_add(1, Ordering::Relaxed);
                if i == 2 { Err(Error::Internal("planted".into())) } else { Ok(vec![1]) }
            });
            if pushed.is_err() {
                break;
            }
        }
        assert_eq!(pushed.unwrap_err().to_string(), Error::Internal("planted".into()).to_string());
        assert!(made.load(Ordering::Relaxed) < 1000);
        assert!(folder.join("1").exists() && !folder.join("2").exists() && !folder.join("3").exists());
        fs::remove_dir_all(folder).unwrap();
    }
}
