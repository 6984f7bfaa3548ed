//! Communicator over the workers of a page: messages by `postMessage`, awaited.

use super::host::Host;
use js_sys::{Array, Uint8Array};
use rebounce::job::communicator::{Communicator, Exchange, Received};
use rebounce::job::watch::{Stopped, Watch};
use wasm_bindgen::JsCast;

/// The workers of one bake.
pub struct Workers<'a> {
    /// Carries the messages.
    pub host: &'a Host,
    /// Rank of this worker, from 0.
    pub rank: usize,
    /// Number of workers.
    pub size: usize,
}

impl Communicator for Workers<'_> {
    fn rank(&self) -> usize {
        self.rank
    }

    fn size(&self) -> usize {
        self.size
    }

    fn is_blocking(&self) -> bool {
        false
    }

    fn exchange<'a>(&'a self, to_first: &'a [u8], to_all: &'a [u8], _watch: &'a dyn Watch) -> Exchange<'a> {
        Box::pin(async move {
            let sent = (Uint8Array::from(to_first), Uint8Array::from(to_all));
            // A worker that died ends the bake.
            let received = self.host.exchange(sent.0, sent.1).await.map_err(|_| Stopped)?;
            let [of_first, of_all] = [0, 1].map(|k| received.unchecked_ref::<Array>().get(k));
            Ok(Received { to_first: bytes(of_first), to_all: bytes(of_all) })
        })
    }
}

/// Copies an array of `Uint8Array`s.
fn bytes(list: wasm_bindgen::JsValue) -> Vec<Vec<u8>> {
    let list: Array = list.unchecked_into();
    list.iter().map(|bytes| bytes.unchecked_into::<Uint8Array>().to_vec()).collect()
}
