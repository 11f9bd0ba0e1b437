plugins {
    alias(libs.plugins.android.library)
    alias(libs.plugins.kotlin.android)
    alias(libs.plugins.kotlin.compose)
    alias(libs.plugins.dokka)
    `maven-publish`
    signing
}

group = "org.magcomp"
version = "0.1.0"

android {
    namespace = "org.magcomp.compose"
    compileSdk = 35
    defaultConfig { minSdk = 21 }
    buildFeatures { compose = true }
    compileOptions {
        sourceCompatibility = JavaVersion.VERSION_1_8
        targetCompatibility = JavaVersion.VERSION_1_8
    }
    // the tests run under Maven, as the library's do
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
    // as the library
    coreLibrariesVersion = "2.2.21"
    explicitApi()
    compilerOptions {
        jvmTarget.set(org.jetbrains.kotlin.gradle.dsl.JvmTarget.JVM_1_8)
        languageVersion.set(org.jetbrains.kotlin.gradle.dsl.KotlinVersion.KOTLIN_2_2)
        apiVersion.set(org.jetbrains.kotlin.gradle.dsl.KotlinVersion.KOTLIN_2_2)
    }
}

dependencies {
    api(project(":library"))
    api(libs.compose.foundation)
    implementation(libs.lifecycle.runtime)
    implementation(libs.lifecycle.runtime.compose)
}

description = "A compass in Jetpack Compose: a rose, a cone for a map, where to turn the phone, each as unsure as the heading is."
extra["artifact"] = "magcomp-compose"
apply(from = rootDir.resolve("gradle/publish.gradle.kts"))
