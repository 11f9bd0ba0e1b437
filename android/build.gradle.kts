plugins {
    alias(libs.plugins.android.library) apply false
    alias(libs.plugins.android.application) apply false
    alias(libs.plugins.kotlin.android) apply false
    alias(libs.plugins.kotlin.compose) apply false
    alias(libs.plugins.dokka) apply false
}

// what the libraries have in common
subprojects {
    plugins.withId("com.android.library") {
        group = "org.magcomp"
        version = "0.1.0"
        extensions.configure<com.android.build.api.dsl.LibraryExtension> {
            compileSdk = 35
            defaultConfig { minSdk = 21 }
            compileOptions {
                sourceCompatibility = JavaVersion.VERSION_1_8
                targetCompatibility = JavaVersion.VERSION_1_8
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
        plugins.withId("org.jetbrains.kotlin.android") {
            extensions.configure<org.jetbrains.kotlin.gradle.dsl.KotlinAndroidProjectExtension> {
                // an app's Kotlin 2.1 reads classes up to 2.2, one minor version newer than itself
                coreLibrariesVersion = "2.2.21"
                compilerOptions {
                    jvmTarget.set(org.jetbrains.kotlin.gradle.dsl.JvmTarget.JVM_1_8)
                    languageVersion.set(org.jetbrains.kotlin.gradle.dsl.KotlinVersion.KOTLIN_2_2)
                    apiVersion.set(org.jetbrains.kotlin.gradle.dsl.KotlinVersion.KOTLIN_2_2)
                }
            }
        }
    }
}
