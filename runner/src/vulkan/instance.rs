//! Loader, instance and, on demand, the validation layer with the list of what it found.

use super::Check;
use crate::error::{Error, Result};
use ash::{ext, vk};
use std::borrow::Cow;
use std::ffi::{CStr, c_void};
use std::sync::{Arc, Mutex, PoisonError};

const VALIDATION_LAYER: &CStr = c"VK_LAYER_KHRONOS_validation";

/// What the validation layer said, oldest first.
pub(super) type MessageLog = Arc<Mutex<Vec<String>>>;

pub(super) struct Instance {
    pub handle: ash::Instance,
    pub has_debug_utils: bool,
    pub messages: MessageLog,
    messenger: Option<(ext::debug_utils::Instance, vk::DebugUtilsMessengerEXT)>,
    /// Destroyed when this drops; else the application does it.
    owned: bool,
    /// Unloads libvulkan when it drops, so it is last.
    pub entry: ash::Entry,
}

impl Instance {
    pub fn new(validate: bool, window_extensions: &[&'static CStr]) -> Result<Instance> {
        // SAFETY: loads the system's Vulkan loader, whose initialisers are trusted.
        let entry = unsafe { ash::Entry::load() }.map_err(|e| Error::NoLoader(e.to_string()))?;
        let layers = if validate { vec![validation_layer(&entry)?] } else { Vec::new() };
        let (extensions, has_debug_utils, has_features) = extensions(&entry, validate, window_extensions)?;

        let messages = MessageLog::default();
        let application = vk::ApplicationInfo::default()
            .application_name(c"candela")
            .engine_name(c"candela")
            .api_version(vk::API_VERSION_1_2);
        let synchronization = [vk::ValidationFeatureEnableEXT::SYNCHRONIZATION_VALIDATION];
        let mut features = vk::ValidationFeaturesEXT::default().enabled_validation_features(&synchronization);
        // In the chain it also sees the creation and destruction of the instance itself.
        let mut early = messenger_info(&messages);
        let mut info = vk::InstanceCreateInfo::default()
            .application_info(&application)
            .enabled_layer_names(&layers)
            .enabled_extension_names(&extensions);
        if validate {
            info = info.push_next(&mut early);
        }
        if has_features {
            info = info.push_next(&mut features);
        }
        // SAFETY: all that `info` points to outlives the call; `messages` outlives the instance.
        let handle = unsafe { entry.create_instance(&info, None) }.map_err(|result| match result {
            vk::Result::ERROR_INCOMPATIBLE_DRIVER => Error::NoDevice { seen: Vec::new() },
            _ => Error::Vulkan { what: "create instance".into(), result },
        })?;
        let mut instance =
            Instance { handle, has_debug_utils, messages, messenger: None, owned: true, entry };
        if validate {
            instance.listen()?;
        }
        Ok(instance)
    }

    /// The instance of an application.
    pub fn borrowed(entry: ash::Entry, handle: ash::Instance, has_debug_utils: bool) -> Instance {
        let messages = MessageLog::default();
        Instance { handle, has_debug_utils, messages, messenger: None, owned: false, entry }
    }

    fn listen(&mut self) -> Result<()> {
        let debug = ext::debug_utils::Instance::new(&self.entry, &self.handle);
        let info = messenger_info(&self.messages);
        // SAFETY: the messenger is destroyed before `messages`, to which it points.
        let messenger =
            unsafe { debug.create_debug_utils_messenger(&info, None) }.check("create debug messenger")?;
        self.messenger = Some((debug, messenger));
        Ok(())
    }
}

impl Drop for Instance {
    fn drop(&mut self) {
        // SAFETY: the device, made from this instance, has been destroyed by its owner.
        unsafe {
            if let Some((debug, messenger)) = self.messenger.take() {
                debug.destroy_debug_utils_messenger(messenger, None);
            }
            if self.owned {
                self.handle.destroy_instance(None);
            }
        }
    }
}

fn validation_layer(entry: &ash::Entry) -> Result<*const std::ffi::c_char> {
    // SAFETY: no preconditions beyond a loaded entry.
    let layers = unsafe { entry.enumerate_instance_layer_properties() }.check("list instance layers")?;
    if !layers.iter().any(|l| l.layer_name_as_c_str() == Ok(VALIDATION_LAYER)) {
        let text = "--validate needs the Khronos validation layer, which isn't installed; \
                    install the package vulkan-validationlayers (Debian, Ubuntu) or the Vulkan SDK";
        return Err(Error::Unsupported(text.into()));
    }
    Ok(VALIDATION_LAYER.as_ptr())
}

/// Names of the extensions to enable, and whether debug utils and validation features are among them.
fn extensions(
    entry: &ash::Entry,
    validate: bool,
    window: &[&'static CStr],
) -> Result<(Vec<*const std::ffi::c_char>, bool, bool)> {
    let list = |layer: Option<&CStr>| {
        // SAFETY: a loaded entry, and a layer that exists.
        unsafe { entry.enumerate_instance_extension_properties(layer) }.check("list instance extensions")
    };
    let mut present = list(None)?;
    if validate {
        present.extend(list(Some(VALIDATION_LAYER))?);
    }
    let has = |name: &CStr| present.iter().any(|e| e.extension_name_as_c_str() == Ok(name));
    if let Some(missing) = window.iter().find(|name| !has(name)) {
        let name = missing.to_string_lossy();
        return Err(Error::Unsupported(format!(
            "no window: the Vulkan driver lacks {name}; render without one"
        )));
    }
    let mut names: Vec<_> = window.iter().map(|name| name.as_ptr()).collect();
    let debug = has(ext::debug_utils::NAME);
    let features = validate && has(ext::validation_features::NAME);
    names.extend(debug.then_some(ext::debug_utils::NAME.as_ptr()));
    names.extend(features.then_some(ext::validation_features::NAME.as_ptr()));
    Ok((names, debug, features))
}

fn messenger_info(messages: &MessageLog) -> vk::DebugUtilsMessengerCreateInfoEXT<'static> {
    use vk::{DebugUtilsMessageSeverityFlagsEXT as Severity, DebugUtilsMessageTypeFlagsEXT as Type};
    vk::DebugUtilsMessengerCreateInfoEXT::default()
        .message_severity(Severity::WARNING | Severity::ERROR)
        // GENERAL is the loader's chatter about other drivers.
        .message_type(Type::VALIDATION | Type::PERFORMANCE)
        .pfn_user_callback(Some(on_message))
        .user_data(Arc::as_ptr(messages).cast_mut().cast())
}

unsafe extern "system" fn on_message(
    _severity: vk::DebugUtilsMessageSeverityFlagsEXT,
    _kind: vk::DebugUtilsMessageTypeFlagsEXT,
    data: *const vk::DebugUtilsMessengerCallbackDataEXT<'_>,
    messages: *mut c_void,
) -> vk::Bool32 {
    // SAFETY: Vulkan passes valid data, and as user data the log that `messenger_info` gave, which still lives.
    let (data, messages) = unsafe { (&*data, &*messages.cast::<Mutex<Vec<String>>>()) };
    // SAFETY: a NUL-terminated string or null.
    let text = unsafe { data.message_as_c_str() }.map_or(Cow::Borrowed(""), CStr::to_string_lossy);
    tracing::error!("validation: {text}");
    messages.lock().unwrap_or_else(PoisonError::into_inner).push(text.into_owned());
    vk::FALSE
}
