//! Work beside the frames: the old scene stays on screen until the new one is whole.

use super::source::Source;
use candela::error::{Error, Result};
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::{Receiver, TryRecvError, channel};
use std::sync::{Arc, Mutex, PoisonError};
use std::thread::JoinHandle;
use std::time::Instant;

/// At most one scene that is being made, of whatever `T` is one.
pub struct Loader<T> {
    job: Option<Job<T>>,
    /// Threads of jobs that were given up: they end at their next stage.
    ending: Vec<JoinHandle<()>>,
}

struct Job<T> {
    source: Source,
    result: Receiver<Result<T>>,
    progress: Arc<Progress>,
    since: Instant,
    thread: JoinHandle<()>,
}

/// What a job is doing, and whether anybody still wants it.
#[derive(Default)]
pub struct Progress {
    stage: Mutex<&'static str>,
    given_up: AtomicBool,
}

impl Progress {
    /// The job begins to do this. Errors: nobody wants it any more.
    pub fn enter(&self, stage: &'static str) -> Result<()> {
        if self.given_up.load(Ordering::Relaxed) {
            return Err(Error::Usage("another scene was asked for".into()));
        }
        *self.stage.lock().unwrap_or_else(PoisonError::into_inner) = stage;
        Ok(())
    }

    fn stage(&self) -> &'static str {
        *self.stage.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

impl<T> Default for Loader<T> {
    fn default() -> Self {
        Loader { job: None, ending: Vec::new() }
    }
}

impl<T: Send + 'static> Loader<T> {
    /// Starts to make `source` by `work`, in a thread; a job that is under way is given up.
    pub fn start(
        &mut self,
        source: Source,
        work: impl FnOnce(&Source, &Progress) -> Result<T> + Send + 'static,
    ) -> Result<()> {
        self.give_up();
        let (sender, result) = channel();
        let progress = Arc::new(Progress::default());
        let (for_thread, its_progress) = (source.clone(), progress.clone());
        let thread = std::thread::Builder::new()
            .name("scene loader".into())
            // Nobody listens any more when another file was dropped meanwhile.
            .spawn(move || drop(sender.send(work(&for_thread, &its_progress))))
            .map_err(|source| Error::NoThread { to: "load the scene", source })?;
        self.job = Some(Job { source, result, progress, since: Instant::now(), thread });
        Ok(())
    }

    /// What has been made since the last call, or why it could not be.
    pub fn poll(&mut self) -> Option<(Source, Result<T>)> {
        let result = match self.job.as_ref()?.result.try_recv() {
            Ok(result) => Some(result),
            Err(TryRecvError::Empty) => return None,
            Err(TryRecvError::Disconnected) => None,
        };
        let Job { source, thread, .. } = self.job.take()?;
        let _ = thread.join();
        let failed = || Err(Error::Internal(format!("{}: loading it failed unexpectedly", source.name())));
        let result = result.unwrap_or_else(failed);
        Some((source, result))
    }
}

impl<T> Loader<T> {
    fn give_up(&mut self) {
        if let Some(job) = self.job.take() {
            job.progress.given_up.store(true, Ordering::Relaxed);
            self.ending.push(job.thread);
        }
        self.ending.retain(|thread| !thread.is_finished());
    }

    /// What is being made, what is being done for it, and for how many seconds it has been.
    pub fn progress(&self) -> Option<(String, &'static str, f32)> {
        let job = self.job.as_ref()?;
        Some((job.source.name(), job.progress.stage(), job.since.elapsed().as_secs_f32()))
    }

    pub fn is_busy(&self) -> bool {
        self.job.is_some()
    }
}

impl<T> Drop for Loader<T> {
    /// The device must not go while a thread uses it.
    fn drop(&mut self) {
        self.give_up();
        for thread in self.ending.drain(..) {
            let _ = thread.join();
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use candela::scene::{Illumination, SceneSource};
    use std::path::Path;
    use std::sync::mpsc;

    fn atrium() -> Source {
        Source { scene: SceneSource::Atrium, illumination: Illumination::points(7) }
    }

    #[test]
    fn a_scene_or_an_error_arrives() {
        let mut loader = Loader::default();
        for (path, good) in
            [("../../assets/scenes/cornell-box.glb", true), ("../../assets/scenes/missing.glb", false)]
        {
            let path = Path::new(env!("CARGO_MANIFEST_DIR")).join(path);
            loader.start(atrium().with_file(&path).unwrap(), |source, _| source.load()).unwrap();
            assert!(loader.is_busy() && loader.progress().is_some());
            let (source, result) = std::iter::repeat_with(|| loader.poll()).find_map(|r| r).unwrap();
            assert_eq!((source.scene, result.is_ok()), (SceneSource::File(path), good));
            assert!(!loader.is_busy());
        }
    }

    /// Only the last one arrives; the one before it ends at its next stage, and a panic is an error.
    #[test]
    fn a_job_is_given_up_for_the_next() {
        let mut loader = Loader::default();
        let (go, wait) = mpsc::channel::<()>();
        let (tell, told) = mpsc::channel();
        let slow = move |_: &Source, progress: &Progress| {
            let started = progress.enter("waiting");
            let _ = tell.send(started.is_err());
            let _ = wait.recv();
            let ended = progress.enter("never");
            let _ = tell.send(ended.is_err());
            ended.map(|()| 1)
        };
        loader.start(atrium(), slow).unwrap();
        assert_eq!(told.recv(), Ok(false));
        loader.start(atrium(), |_, _| Ok(2)).unwrap();
        let (_, result) = std::iter::repeat_with(|| loader.poll()).find_map(|r| r).unwrap();
        assert_eq!(result.unwrap(), 2);
        drop(go);
        assert_eq!(told.recv(), Ok(true));
        loader.start(atrium(), |_, _| panic!("a planted panic")).unwrap();
        let (_, result) = std::iter::repeat_with(|| loader.poll()).find_map(|r| r).unwrap();
        assert!(result.unwrap_err().to_string().contains("unexpectedly"));
    }
}
