//! uniffi's own command line, pinned by Cargo.lock. Used by `bindings/generate.sh`.

fn main() {
    uniffi::uniffi_bindgen_main();
}
