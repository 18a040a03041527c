//! How the module is linked: with as much stack as deeply nested expressions need, and small.

fn main() {
    println!("cargo:rerun-if-changed=build.rs");
    if std::env::var("CARGO_CFG_TARGET_ARCH").as_deref() == Ok("wasm32") {
        println!("cargo:rustc-cdylib-link-arg=-zstack-size=8388608");
        // addresses in as few bytes as they need, not in five
        println!("cargo:rustc-cdylib-link-arg=--compress-relocations");
    }
}
