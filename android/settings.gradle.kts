// The build that an app's developer knows, over the same folders as Maven's: the AARs, one with its native libraries, and the sample.
pluginManagement {
    repositories {
        google()
        mavenCentral()
        gradlePluginPortal()
    }
}

dependencyResolutionManagement {
    repositoriesMode.set(RepositoriesMode.FAIL_ON_PROJECT_REPOS)
    repositories {
        google()
        mavenCentral()
    }
}

rootProject.name = "magcomp-android"
include(":library", ":compose", ":sample")
