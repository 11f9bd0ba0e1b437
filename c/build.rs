//! The name by which a program asks for the shared library when it starts. Before 1.0 each minor version may have another ABI, so the name has both numbers.

fn main() {
    let version = |part: &str| std::env::var(format!("CARGO_PKG_VERSION_{part}")).expect("cargo sets it");
    let abi = format!("{}.{}", version("MAJOR"), version("MINOR"));
    match std::env::var("CARGO_CFG_TARGET_OS").as_deref() {
        Ok("linux") => println!("cargo::rustc-cdylib-link-arg=-Wl,-soname,libmagcomp.so.{abi}"),
        Ok("macos") => println!("cargo::rustc-cdylib-link-arg=-Wl,-install_name,@rpath/libmagcomp.{abi}.dylib"),
        _ => {}
    }
    println!("cargo::rerun-if-changed=build.rs");
}
