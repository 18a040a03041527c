//! No start files, no libraries. The arguments are those of a linker for Linux: other targets' have neither
//! to leave out.
fn main() {
    if std::env::var("CARGO_CFG_TARGET_OS").as_deref() != Ok("linux") {
        return;
    }
    println!("cargo::rustc-link-arg-bins=-nostartfiles");
    println!("cargo::rustc-link-arg-bins=-nostdlib");
    println!("cargo::rustc-link-arg-bins=-nodefaultlibs");
    println!("cargo::rustc-link-arg-bins=-static");
}
