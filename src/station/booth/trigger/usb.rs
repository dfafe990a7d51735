//! A USB device with a button of its own: input reports from its interrupt endpoint.

use std::time::Duration;

use gaiter_flow::cause::Cause;
use gaiter_flow::trigger::{Input, PortFault, PortFaultKind};
use rusb::{
    ConfigDescriptor, Context, DeviceHandle, Direction, Error, Recipient, RequestType,
    TransferType, UsbContext,
};

use super::port::{Port, PortOpener, fault};
use crate::config::port::UsbName;
use crate::config::trigger::UsbTrigger;

/// The longest input report, bytes: the limit of an interrupt endpoint at full speed.
const REPORT_MOST: usize = 64;

/// How long a device may take to answer.
const ANSWER: Duration = Duration::from_millis(200);

/// The request that sends a report to a human interface device (HID 1.11, section 7.2.2), …
const SET_REPORT: u8 = 0x09;

/// … and the type of report that controls its lights.
const OUTPUT_REPORT: u16 = 0x0200;

/// Where to look for a USB device.
#[derive(Debug)]
pub struct UsbOpener(pub UsbTrigger);

impl PortOpener for UsbOpener {
    fn open(&mut self) -> Result<Box<dyn Port>, PortFault> {
        // A new context each time: libusb lists the devices present when its context is made, and
        // learns of later ones over a socket that a service without a network does not have. Never the
        // crate's global context, which panics if there is no bus.
        let context = Context::new().map_err(|error| {
            fault(PortFaultKind::Absent, format!("this machine shows no USB bus: {error}"))
        })?;
        let handle = find(&context, &self.0.device)?;
        let described = handle.device().active_config_descriptor().map_err(of_usb)?;
        let silent =
            || fault(PortFaultKind::Failed, "it has no interrupt endpoint into the computer");
        let (interface, endpoint) = reports(&described).ok_or_else(silent)?;
        // The kernel's driver gets the interface back when it is released.
        match handle.set_auto_detach_kernel_driver(true) {
            Ok(()) | Err(Error::NotSupported) => {}
            Err(error) => return Err(of_usb(error)),
        }
        handle.claim_interface(interface).map_err(of_usb)?;
        Ok(Box::new(OpenUsb { handle, interface, endpoint }))
    }
}

fn find(context: &Context, name: &UsbName) -> Result<DeviceHandle<Context>, PortFault> {
    let mut refused = None;
    for device in context.devices().map_err(of_usb)?.iter() {
        let Ok(descriptor) = device.device_descriptor() else { continue };
        if (descriptor.vendor_id(), descriptor.product_id()) != (name.vendor, name.product) {
            continue;
        }
        match device.open() {
            Ok(handle) => {
                let Some(serial) = &name.serial else { return Ok(handle) };
                match handle.read_serial_number_string_ascii(&descriptor) {
                    Ok(found) if found == *serial => return Ok(handle),
                    Ok(_) | Err(Error::InvalidParam | Error::NotFound) => {}
                    Err(error) => refused = Some(of_usb(error)),
                }
            }
            Err(error) => refused = Some(of_usb(error)),
        }
    }
    let absent = || fault(PortFaultKind::Absent, Cause::known("no-usb-device", []));
    Err(refused.unwrap_or_else(absent))
}

/// The interface that sends the input reports, and its endpoint: the first interrupt endpoint into the computer.
fn reports(described: &ConfigDescriptor) -> Option<(u8, u8)> {
    // An interface begins with the setting that it is in; nothing here sets another.
    let mut interfaces = described.interfaces().filter_map(|known| known.descriptors().next());
    interfaces.find_map(|interface| {
        let endpoint = interface.endpoint_descriptors().find(|endpoint| {
            endpoint.direction() == Direction::In
                && endpoint.transfer_type() == TransferType::Interrupt
        })?;
        Some((interface.interface_number(), endpoint.address()))
    })
}

/// An open device with its interface claimed.
struct OpenUsb {
    handle: DeviceHandle<Context>,
    interface: u8,
    endpoint: u8,
}

impl Port for OpenUsb {
    fn read(&mut self, timeout: Duration) -> Result<Input, PortFault> {
        let mut report = [0; REPORT_MOST];
        // To libusb, less than a millisecond means forever.
        let timeout = timeout.max(Duration::from_millis(1));
        match self.handle.read_interrupt(self.endpoint, &mut report, timeout) {
            Ok(count) => Ok(Input::Report(report[..count.min(REPORT_MOST)].to_vec())),
            Err(Error::Timeout | Error::Interrupted) => Ok(Input::Nothing),
            Err(error) => Err(of_usb(error)),
        }
    }

    fn write(&mut self, bytes: &[u8]) -> Result<(), PortFault> {
        let Some((number, data)) = bytes.split_first() else { return Ok(()) };
        // As with /dev/hidraw: a device without numbered reports gets no report number.
        let report = if *number == 0 { data } else { bytes };
        let to = rusb::request_type(Direction::Out, RequestType::Class, Recipient::Interface);
        let (kind, interface) = (OUTPUT_REPORT | u16::from(*number), u16::from(self.interface));
        let sent = self.handle.write_control(to, SET_REPORT, kind, interface, report, ANSWER);
        sent.map(|_| ()).map_err(of_usb)
    }
}

impl Drop for OpenUsb {
    fn drop(&mut self) {
        // Gives the interface back to the kernel's driver; this may fail if the device is gone.
        let _ = self.handle.release_interface(self.interface);
    }
}

/// Converts a fault of libusb.
fn of_usb(error: Error) -> PortFault {
    let kind = match error {
        Error::NoDevice | Error::NotFound => PortFaultKind::Absent,
        Error::Access => PortFaultKind::Denied,
        Error::Busy => PortFaultKind::Busy,
        _ => PortFaultKind::Failed,
    };
    fault(kind, error.to_string())
}
