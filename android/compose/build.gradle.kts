plugins {
    alias(libs.plugins.android.library)
    alias(libs.plugins.kotlin.android)
    alias(libs.plugins.kotlin.compose)
    alias(libs.plugins.dokka)
    `maven-publish`
    signing
}

android {
    namespace = "org.magcomp.compose"
    buildFeatures { compose = true }
}

kotlin { explicitApi() }

dependencies {
    api(project(":library"))
    api(libs.compose.foundation)
    implementation(libs.lifecycle.runtime)
    implementation(libs.lifecycle.runtime.compose)
}

description = "A compass in Jetpack Compose: a rose, a cone for a map, where to turn the phone, each as unsure as the heading is."
extra["artifact"] = "magcomp-compose"
apply(from = rootDir.resolve("gradle/publish.gradle.kts"))
