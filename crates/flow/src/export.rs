//! Files of an export: their stamps and companions, how they are written, and where they are stored.

pub mod companions;
pub mod file_system;
pub mod mask;
pub mod mount;
pub mod passed_over;
pub mod space;
pub mod stamp;
pub mod writing;
