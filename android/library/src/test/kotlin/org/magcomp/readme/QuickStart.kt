package org.magcomp.readme

import android.content.res.Resources
import kotlinx.coroutines.flow.Flow
import kotlinx.coroutines.flow.map
import org.magcomp.Compass

// what follows is in README.md; ReadmeTest compares them
fun headings(compass: Compass, resources: Resources): Flow<String> = compass.headings().map { reading ->
    val headingDeg = reading.headingDeg ?: return@map reading.text(resources) // a sentence that says what is missing
    "$headingDeg deg +- ${reading.headingSigmaDeg}"
}
