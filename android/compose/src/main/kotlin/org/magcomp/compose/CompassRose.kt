package org.magcomp.compose

import androidx.compose.foundation.Canvas
import androidx.compose.foundation.layout.Box
import androidx.compose.foundation.layout.fillMaxSize
import androidx.compose.foundation.layout.padding
import androidx.compose.foundation.text.BasicText
import androidx.compose.runtime.Composable
import androidx.compose.ui.Alignment
import androidx.compose.ui.Modifier
import androidx.compose.ui.draw.rotate
import androidx.compose.ui.geometry.Offset
import androidx.compose.ui.graphics.Color
import androidx.compose.ui.graphics.drawscope.DrawScope
import androidx.compose.ui.graphics.drawscope.Stroke
import androidx.compose.ui.graphics.graphicsLayer
import androidx.compose.ui.semantics.clearAndSetSemantics
import androidx.compose.ui.semantics.contentDescription
import androidx.compose.ui.text.TextStyle
import androidx.compose.ui.unit.dp
import androidx.compose.ui.unit.sp
import kotlin.math.ceil

/** The colours of a [CompassRose]: the needle, its sector and north's letter; the other letters and the lubber line; the ring. */
public class RoseColors(public val north: Color, public val text: Color, public val ring: Color)

/**
 * One standard deviation as [CompassRose] and [HeadingCone] draw it, and as a screen reader says it: whole degrees, rounded up; 180 where it is
 * null or none. Write this number beside them, so that all say the same.
 */
public fun shownSigmaDeg(sigmaDeg: Double?): Int = ceil((sigmaDeg?.takeIf { it >= 0 } ?: UNKNOWN_DEG).coerceAtMost(UNKNOWN_DEG)).toInt()

private const val UNKNOWN_DEG = 180.0

/**
 * A rose that turns against the heading. Its sector reaches [shownSigmaDeg] to either side of north: north lies in it two times of three. The
 * letters stay upright.
 *
 * ```
 * CompassRose(reading.headingDeg, reading.headingSigmaDeg, reading.spoken(resources), colors, Modifier.size(260.dp))
 * ```
 *
 * @param headingDeg clockwise from north, degrees; null or what is no number: the ring alone
 * @param sigmaDeg one standard deviation, degrees; null or what is none: nothing is known, the sector is the whole rose
 * @param spoken what a screen reader says of all of it
 * @param letters those of north, east, south and west
 */
@Composable
public fun CompassRose(
    headingDeg: Double?,
    sigmaDeg: Double?,
    spoken: String,
    colors: RoseColors,
    modifier: Modifier = Modifier,
    letters: List<String> = listOf("N", "E", "S", "W"),
) {
    Box(modifier.clearAndSetSemantics { contentDescription = spoken }) {
        Canvas(Modifier.fillMaxSize()) {
            drawCircle(colors.ring, style = Stroke(2.dp.toPx()))
            // the lubber line: where the phone points, whatever the rose says
            drawLine(colors.text, Offset(center.x, 0f), Offset(center.x, 8.dp.toPx()), 3.dp.toPx())
        }
        val shownDeg = headingDeg?.takeIf { it.isFinite() } ?: return@Box
        val turnedDeg = (shownDeg % 360).toFloat()
        // a layer is turned as it is: neither needle nor letters are laid out or drawn again
        Box(Modifier.fillMaxSize().graphicsLayer { rotationZ = -turnedDeg }) {
            Canvas(Modifier.fillMaxSize()) {
                sector(colors.north, shownSigmaDeg(sigmaDeg))
                drawLine(colors.north, center, Offset(center.x, 40.dp.toPx()), 3.dp.toPx())
            }
            letters.forEachIndexed { k, letter ->
                Box(Modifier.fillMaxSize().rotate(90f * k).padding(8.dp), contentAlignment = Alignment.TopCenter) {
                    val color = if (k == 0) colors.north else colors.text
                    BasicText(letter, Modifier.graphicsLayer { rotationZ = turnedDeg - 90f * k }, TextStyle(color = color, fontSize = 22.sp))
                }
            }
        }
    }
}

/**
 * A cone that points along the heading, for the dot of a map: as wide as [shownSigmaDeg] to either side. It draws nothing without a heading.
 *
 * @param headingDeg clockwise from the north that is at the top of the map, degrees: the true heading for a map that is not turned
 * @param sigmaDeg as that of [CompassRose]
 */
@Composable
public fun HeadingCone(headingDeg: Double?, sigmaDeg: Double?, color: Color, modifier: Modifier = Modifier) {
    val shownDeg = headingDeg?.takeIf { it.isFinite() } ?: return
    Canvas(modifier.graphicsLayer { rotationZ = (shownDeg % 360).toFloat() }) { sector(color, shownSigmaDeg(sigmaDeg)) }
}

/** So many degrees to either side of what is at the top. */
private fun DrawScope.sector(color: Color, halfDeg: Int) =
    drawArc(color.copy(alpha = 0.25f), -90f - halfDeg, 2f * halfDeg, useCenter = true)
