package org.magcomp.readme

import android.content.Context
import kotlinx.coroutines.flow.Flow
import kotlinx.coroutines.flow.map
import org.magcomp.Compass

// what follows is in README.md; ReadmeTest compares them
fun headings(context: Context): Flow<String> = Compass(context).readings().map { (reading) ->
    val heading = reading.heading ?: return@map reading.status.text() // a sentence that says what is missing
    "${heading.headingDeg} deg +- ${heading.headingSigmaDeg}"
}
