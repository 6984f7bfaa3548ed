//! A channel for a single value from a callback to a future; works without threads and without an executor.

use std::future::Future;
use std::pin::Pin;
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use std::task::{Context, Poll, Waker};

struct SlotState<T> {
    value: Option<T>,
    waker: Option<Waker>,
}

/// The sending half; cheap to clone. The last value sent wins.
pub struct Sender<T>(Arc<Mutex<SlotState<T>>>);

/// The receiving half: a future of the value. Pending forever if no value is sent.
pub struct Receiver<T>(Arc<Mutex<SlotState<T>>>);

/// A connected pair.
pub fn channel<T>() -> (Sender<T>, Receiver<T>) {
    let state = Arc::new(Mutex::new(SlotState { value: None, waker: None }));
    (Sender(state.clone()), Receiver(state))
}

fn lock<T>(state: &Mutex<SlotState<T>>) -> MutexGuard<'_, SlotState<T>> {
    state.lock().unwrap_or_else(PoisonError::into_inner)
}

impl<T> Sender<T> {
    /// Sends the value and wakes the receiver.
    pub fn send(&self, value: T) {
        let waker = {
            let mut state = lock(&self.0);
            state.value = Some(value);
            state.waker.take()
        };
        if let Some(waker) = waker {
            waker.wake();
        }
    }
}

impl<T> Receiver<T> {
    /// The value, if already sent.
    pub fn try_take(&self) -> Option<T> {
        lock(&self.0).value.take()
    }
}

impl<T> Future for Receiver<T> {
    type Output = T;

    fn poll(self: Pin<&mut Self>, context: &mut Context<'_>) -> Poll<T> {
        let mut state = lock(&self.0);
        match state.value.take() {
            Some(value) => Poll::Ready(value),
            None => {
                state.waker = Some(context.waker().clone());
                Poll::Pending
            }
        }
    }
}
