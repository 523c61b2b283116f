//! A device for tests.

use super::device::{Device, DeviceOptions};

/// Runs `test` on a device under validation, which must have nothing to say, even when all is destroyed. Without a
/// device the test fails, unless CANDELA_ALLOW_NO_GPU=1 says that there is none here.
pub fn with_device(test: impl FnOnce(&Device)) {
    let Some(device) = device() else { return };
    let log = device.message_log().clone();
    test(&device);
    assert_eq!(device.memory_used(), 0, "memory is still allocated");
    drop(device);
    let messages = log.lock().unwrap();
    assert!(messages.is_empty(), "validation:\n{}", messages.join("\n"));
}

pub fn device() -> Option<Device> {
    match Device::new(&DeviceOptions { validate: true, ..Default::default() }) {
        Ok(device) => Some(device),
        Err(error) if std::env::var("CANDELA_ALLOW_NO_GPU").is_ok_and(|v| v == "1") => {
            eprintln!("skipped: {error}");
            None
        }
        Err(error) => panic!("{error} (CANDELA_ALLOW_NO_GPU=1 skips the tests that need a device)"),
    }
}
