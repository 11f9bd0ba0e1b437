plugins {
    alias(libs.plugins.android.library)
    alias(libs.plugins.kotlin.android)
    alias(libs.plugins.dokka)
    `maven-publish`
    signing
}

group = "org.magcomp"
version = "0.1.0"

// the native libraries of android/build-native.sh, which needs the NDK and cargo-ndk
val nativeLibraries = rootDir.resolve("../target/android")
val buildNative by tasks.registering(Exec::class) {
    commandLine(rootDir.resolve("build-native.sh").path)
    environment("CARGO_TARGET_DIR", rootDir.resolve("../target").path)
}

android {
    namespace = "org.magcomp"
    compileSdk = 35
    defaultConfig {
        minSdk = 21
        consumerProguardFiles(rootDir.resolve("aar/src/main/aar/proguard.txt"))
    }
    compileOptions {
        sourceCompatibility = JavaVersion.VERSION_1_8
        targetCompatibility = JavaVersion.VERSION_1_8
    }
    sourceSets.getByName("main") {
        java.srcDir(rootDir.resolve("../bindings/kotlin"))
        java.srcDir(rootDir.resolve("bindings/src/main/kotlin"))
        jniLibs.srcDir(nativeLibraries)
    }
    // the tests run on the host, under Maven: they need the framework's real classes
    sourceSets.getByName("test").java.setSrcDirs(emptyList<String>())
    lint { warningsAsErrors = true }
    publishing {
        singleVariant("release") {
            withSourcesJar()
            withJavadocJar()
        }
    }
}

kotlin {
    // an app's Kotlin 2.1 reads classes up to 2.2, one minor version newer than itself
    coreLibrariesVersion = "2.2.21"
    compilerOptions {
        jvmTarget.set(org.jetbrains.kotlin.gradle.dsl.JvmTarget.JVM_1_8)
        languageVersion.set(org.jetbrains.kotlin.gradle.dsl.KotlinVersion.KOTLIN_2_2)
        apiVersion.set(org.jetbrains.kotlin.gradle.dsl.KotlinVersion.KOTLIN_2_2)
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
