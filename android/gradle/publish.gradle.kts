// What is published of a module: its release, by the name that it gives `extra["artifact"]`, signed in a release alone
// (ORG_GRADLE_PROJECT_signingKey and ORG_GRADLE_PROJECT_signingPassword).
configure<PublishingExtension> {
    publications.register<MavenPublication>("release") {
        artifactId = project.extra["artifact"] as String
        afterEvaluate { from(components["release"]) }
        pom {
            name.set(artifactId)
            description.set(project.description)
            val home = "https://github.com/OWNER/magcomp"
            url.set(home)
            licenses {
                license { name.set("MIT"); url.set("https://opensource.org/license/mit") }
                license { name.set("Apache-2.0"); url.set("https://www.apache.org/licenses/LICENSE-2.0") }
            }
            developers { developer { name.set("The magcomp authors") } }
            scm { url.set(home); connection.set("scm:git:$home.git") }
        }
    }
}

configure<SigningExtension> {
    val key = providers.gradleProperty("signingKey").orNull
    if (key != null) {
        useInMemoryPgpKeys(key, providers.gradleProperty("signingPassword").orNull)
        sign(extensions.getByType<PublishingExtension>().publications)
    }
}
