//! Which GPU draws, and how is it reached?

use crate::error::RenderError;
use std::future::{Future, poll_fn};
use std::sync::{Arc, Mutex, PoisonError};
use std::task::{Poll, Waker};

/// A device with its queue, and the name of the adapter behind it.
#[derive(Clone, Debug)]
pub struct Gpu {
    /// Makes textures and pipelines.
    pub device: wgpu::Device,
    /// Takes commands.
    pub queue: wgpu::Queue,
    adapter: Arc<str>,
}

impl Gpu {
    /// Opens the best adapter, a software one when there is nothing better.
    ///
    /// The device has all that the adapter has: see [`Self::of_adapter`].
    ///
    /// ```
    /// # #[cfg(not(target_arch = "wasm32"))] {
    /// let gpu = pollster::block_on(foveal_render::Gpu::open())?;
    /// println!("draws with {}", gpu.adapter_name());
    /// # }
    /// # Ok::<(), foveal_render::RenderError>(())
    /// ```
    pub async fn open() -> Result<Self, RenderError> {
        let instance = wgpu::Instance::new(wgpu::InstanceDescriptor {
            flags: wgpu::InstanceFlags::empty(),
            ..wgpu::InstanceDescriptor::new_without_display_handle()
        });
        let adapter = Self::request_adapter(&instance).await?;
        Self::of_adapter(&adapter).await
    }

    /// Opens a device of an adapter, with the adapter's own limits: a device of a browser's default
    /// ones binds 128 MiB, whatever the GPU has. Where a driver gives no such device, the default
    /// limits are asked for, or less where the adapter has less.
    ///
    /// # Errors
    /// [`RenderError::NoDevice`] when the adapter gives none.
    pub async fn of_adapter(adapter: &wgpu::Adapter) -> Result<Self, RenderError> {
        let own = adapter.limits();
        let usual = wgpu::Limits::default().or_worse_values_from(&own);
        let mut opened = adapter.request_device(&described(adapter, own)).await;
        if opened.is_err() {
            opened = adapter.request_device(&described(adapter, usual)).await;
        }
        let name = describe(&adapter.get_info());
        match opened {
            Ok((device, queue)) => Ok(Self {
                device,
                queue,
                adapter: name.into(),
            }),
            Err(reason) => Err(RenderError::NoDevice {
                adapter: name,
                reason: reason.to_string(),
            }),
        }
    }

    /// What `make` makes, where the GPU's memory has room for its `bytes`.
    ///
    /// # Errors
    /// [`RenderError::OutOfMemory`] when it has not; in a browser that shows later, in what is
    /// drawn.
    pub(crate) fn roomed<T>(
        &self,
        (what, bytes): (&'static str, u64),
        make: impl FnOnce(&wgpu::Device) -> T,
    ) -> Result<T, RenderError> {
        #[cfg(target_arch = "wasm32")]
        {
            let _ = (what, bytes);
            Ok(make(&self.device))
        }
        #[cfg(not(target_arch = "wasm32"))]
        {
            let scope = self.device.push_error_scope(wgpu::ErrorFilter::OutOfMemory);
            let made = make(&self.device);
            match pollster::block_on(scope.pop()) {
                None => Ok(made),
                Some(_) => Err(RenderError::OutOfMemory { what, bytes }),
            }
        }
    }

    /// What `make` makes; `None` where the device was lost: what a lost one makes is invalid, and
    /// an error as soon as it is used. A browser's device takes it and does nothing.
    pub(crate) fn unless_lost<T>(&self, make: impl FnOnce() -> T) -> Option<T> {
        #[cfg(target_arch = "wasm32")]
        {
            Some(make())
        }
        #[cfg(not(target_arch = "wasm32"))]
        {
            let scope = self.device.push_error_scope(wgpu::ErrorFilter::Validation);
            let made = make();
            match pollster::block_on(scope.pop()) {
                None => Some(made),
                Some(_) => None,
            }
        }
    }

    /// [`Self::open`], waited for.
    #[cfg(not(target_arch = "wasm32"))]
    pub fn open_blocking() -> Result<Self, RenderError> {
        pollster::block_on(Self::open())
    }

    /// Draws on a device that a window already opened.
    #[must_use]
    pub fn from_parts(device: wgpu::Device, queue: wgpu::Queue) -> Self {
        let adapter = describe(&device.adapter_info()).into();
        Self {
            device,
            queue,
            adapter,
        }
    }

    /// What the passes of a frame are recorded into, in their order, for [`Self::submit`].
    ///
    /// What is written to a buffer or a texture meanwhile is there before the first of them runs:
    /// a pass that comes twice in a frame needs parameters of its own for each.
    #[must_use]
    pub fn encoder(&self, label: &'static str) -> wgpu::CommandEncoder {
        let descriptor = wgpu::CommandEncoderDescriptor { label: Some(label) };
        self.device.create_command_encoder(&descriptor)
    }

    /// Hands all that was recorded to the device, which begins with it.
    pub fn submit(&self, encoder: wgpu::CommandEncoder) {
        self.queue.submit([encoder.finish()]);
    }

    /// Blocks until the device has done all that was submitted and holds all that was written.
    ///
    /// # Errors
    /// [`RenderError::ReadBack`] when the device is lost.
    #[cfg(not(target_arch = "wasm32"))]
    pub(crate) fn settle(&self) -> Result<(), RenderError> {
        self.queue.submit([]);
        let done = self.device.poll(wgpu::PollType::wait_indefinitely());
        done.map(|_| ())
            .map_err(|reason| RenderError::ReadBack(reason.to_string()))
    }

    /// Name, driver and interface of the adapter, for people.
    #[must_use]
    pub fn adapter_name(&self) -> &str {
        &self.adapter
    }

    /// Waits until all that was asked of the GPU so far is done.
    pub fn done(&self) -> impl Future<Output = ()> + use<> {
        let state = Arc::new(Mutex::new((false, None::<Waker>)));
        let told = Arc::clone(&state);
        self.queue.on_submitted_work_done(move || {
            let mut told = told.lock().unwrap_or_else(PoisonError::into_inner);
            told.0 = true;
            if let Some(waker) = told.1.take() {
                waker.wake();
            }
        });
        poll_fn(move |context| {
            let mut state = state.lock().unwrap_or_else(PoisonError::into_inner);
            if state.0 {
                return Poll::Ready(());
            }
            state.1 = Some(context.waker().clone());
            Poll::Pending
        })
    }

    async fn request_adapter(instance: &wgpu::Instance) -> Result<wgpu::Adapter, RenderError> {
        let mut options = wgpu::RequestAdapterOptions {
            power_preference: wgpu::PowerPreference::HighPerformance,
            ..wgpu::RequestAdapterOptions::default()
        };
        if let Ok(adapter) = instance.request_adapter(&options).await {
            return Ok(adapter);
        }
        options.force_fallback_adapter = true;
        instance
            .request_adapter(&options)
            .await
            .map_err(|reason| RenderError::NoAdapter(reason.to_string()))
    }
}

fn described(adapter: &wgpu::Adapter, limits: wgpu::Limits) -> wgpu::DeviceDescriptor<'static> {
    wgpu::DeviceDescriptor {
        label: Some("foveal"),
        // Measures how long passes take; nothing else depends on it.
        required_features: adapter.features() & wgpu::Features::TIMESTAMP_QUERY,
        required_limits: limits,
        ..wgpu::DeviceDescriptor::default()
    }
}

fn describe(info: &wgpu::AdapterInfo) -> String {
    let driver = [info.driver.as_str(), info.driver_info.as_str()].join(" ");
    let mut parts = vec![driver.trim().to_owned(), info.backend.to_string()];
    parts.retain(|part| !part.is_empty());
    let rest = parts.join(", ");
    // A browser may report nothing but the interface.
    match info.name.as_str() {
        "" => rest,
        name => format!("{name} ({rest})"),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn described(name: &str, driver: &str, backend: wgpu::Backend) -> String {
        let mut info = wgpu::AdapterInfo::new(wgpu::DeviceType::Other, backend);
        info.name = name.to_owned();
        info.driver = driver.to_owned();
        describe(&info)
    }

    #[test]
    fn a_device_has_the_limits_of_its_adapter() {
        let instance = wgpu::Instance::new(wgpu::InstanceDescriptor {
            flags: wgpu::InstanceFlags::empty(),
            ..wgpu::InstanceDescriptor::new_without_display_handle()
        });
        let adapter = pollster::block_on(Gpu::request_adapter(&instance)).unwrap();
        let gpu = pollster::block_on(Gpu::of_adapter(&adapter)).unwrap();
        let (own, found) = (adapter.limits(), gpu.device.limits());
        assert_eq!(found.max_texture_dimension_2d, own.max_texture_dimension_2d);
        assert_eq!(found.max_buffer_size, own.max_buffer_size);
        assert_eq!(
            found.max_storage_buffer_binding_size,
            own.max_storage_buffer_binding_size
        );
    }

    #[test]
    fn an_adapter_is_described_by_what_is_known_of_it_alone() {
        let native = described("A1", "mesa", wgpu::Backend::Vulkan);
        assert_eq!(native, "A1 (mesa, vulkan)");
        let named = described("A1", "", wgpu::Backend::BrowserWebGpu);
        assert_eq!(named, "A1 (webgpu)");
        let unnamed = described("", "", wgpu::Backend::BrowserWebGpu);
        assert_eq!(unnamed, "webgpu");
    }
}
