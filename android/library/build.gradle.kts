plugins {
    alias(libs.plugins.android.library)
    alias(libs.plugins.kotlin.android)
    alias(libs.plugins.dokka)
    `maven-publish`
    signing
}

// the native libraries of android/build-native.sh, which needs the NDK and cargo-ndk
val nativeLibraries = rootDir.resolve("../target/android")
val buildNative by tasks.registering(Exec::class) {
    commandLine(rootDir.resolve("build-native.sh").path)
    environment("CARGO_TARGET_DIR", rootDir.resolve("../target").path)
}

android {
    namespace = "org.magcomp"
    defaultConfig { consumerProguardFiles(rootDir.resolve("aar/src/main/aar/proguard.txt")) }
    sourceSets.getByName("main") {
        java.srcDir(rootDir.resolve("../bindings/kotlin"))
        java.srcDir(rootDir.resolve("bindings/src/main/kotlin"))
        jniLibs.srcDir(nativeLibraries)
    }
}

tasks.named("preBuild") { dependsOn(buildNative) }

dependencies {
    api(libs.coroutines.android)
    // the aar: the jar has no libraries for Android
    implementation(libs.jna) { artifact { type = "aar" } }
}

description = "A compass library for phones: it keeps pointing north when a magnet is put on the phone, and says how far off it may be."
extra["artifact"] = "magcomp"
apply(from = rootDir.resolve("gradle/publish.gradle.kts"))
