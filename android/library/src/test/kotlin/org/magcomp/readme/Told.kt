package org.magcomp.readme

import android.content.res.Resources
import kotlinx.coroutines.flow.Flow
import kotlinx.coroutines.flow.catch
import kotlinx.coroutines.flow.map
import org.magcomp.Compass
import org.magcomp.CompassException
import org.magcomp.text

// what follows is in docs/FRAMEWORKS.md; ReadmeTest compares them
/** What JavaScript and Dart are told: the heading, or the sentence that says what is missing. */
fun told(compass: Compass, resources: Resources): Flow<Map<String, Any?>> = compass.headings()
    .map { mapOf("headingDeg" to it.headingDeg, "sigmaDeg" to it.headingSigmaDeg, "text" to it.text(resources)) }
    .catch { emit(mapOf("headingDeg" to null, "sigmaDeg" to null, "text" to ((it as? CompassException)?.text(resources) ?: "$it"))) }
