#![no_main]

libfuzzer_sys::fuzz_target!(|data: &[u8]| magcomp_tests::fuzz::stream(data));
