pub mod test_leg;
