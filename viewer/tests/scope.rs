//! Ownership of GPU resources, and attribution of errors to handles.
#![allow(clippy::unwrap_used, reason = "a test that cannot go on fails")]

use crate::common;

use rebounce_viewer::gpu::Gpu;
use rebounce_viewer::scope::Scope;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use wgpu::BufferUsages;

fn buffer(scope: &Scope, size: u64) -> wgpu::Buffer {
    let usage = BufferUsages::COPY_DST | BufferUsages::COPY_SRC;
    scope.buffer(&wgpu::BufferDescriptor { label: None, size, usage, mapped_at_creation: false })
}

/// Copies a buffer to another; an error for a destroyed buffer.
fn copy(gpu: &Gpu, from: &wgpu::Buffer, to: &wgpu::Buffer) {
    let mut encoder = gpu.device.create_command_encoder(&Default::default());
    encoder.copy_buffer_to_buffer(from, 0, to, 0, 16);
    gpu.queue.submit([encoder.finish()]);
}

#[test]
fn what_a_scope_made_is_usable_until_it_is_dropped_and_destroyed_then() {
    let Some(gpu) = common::gpu() else { return };
    let (kept, dropped) = (Scope::new(&gpu), Scope::new(&gpu));
    let (a, b) = (buffer(&kept, 32), buffer(&dropped, 64));
    assert_eq!((kept.bytes(), dropped.bytes()), (32, 64));
    copy(&gpu, &b, &a);
    gpu.check().unwrap();
    drop(dropped);
    copy(&gpu, &b, &a);
    let error = gpu.check().unwrap_err().to_string();
    assert!(error.contains("destroyed"), "{error}");
    copy(&gpu, &a, &buffer(&kept, 16));
    gpu.check().unwrap();
    assert_eq!(kept.bytes(), 48);
}

#[test]
fn a_failure_is_told_to_the_handle_that_watched() {
    let Some(gpu) = common::gpu() else { return };
    let (first, second) = (gpu.share(), gpu.share());
    let scope = Scope::new(&second);
    // Larger than any device allows.
    second.watch(|| buffer(&scope, 1 << 60));
    first.check().unwrap();
    gpu.check().unwrap();
    assert!(second.check().is_err());
    second.check().unwrap();
}

#[test]
fn a_device_lives_as_long_as_any_handle() {
    let Some(gpu) = common::gpu() else { return };
    let scope = Scope::new(&gpu.share());
    drop(gpu);
    let (a, b) = (buffer(&scope, 16), buffer(&scope, 16));
    copy(&scope, &a, &b);
    scope.check().unwrap();
    let (told, device) = (Arc::new(AtomicBool::new(false)), scope.device.clone());
    let tell = told.clone();
    device.set_device_lost_callback(move |_, _| tell.store(true, Ordering::Relaxed));
    // Keeps the queue alive; without the queue no message arrives.
    let _queue = scope.queue.clone();
    let look = || drop(device.poll(wgpu::PollType::wait_indefinitely()));
    look();
    assert!(!told.load(Ordering::Relaxed), "lost while somebody holds it");
    drop(scope);
    look();
    assert!(told.load(Ordering::Relaxed), "alive though nobody holds it");
}
