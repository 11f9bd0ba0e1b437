package org.magcomp.compose

import androidx.compose.foundation.Canvas
import androidx.compose.runtime.Composable
import androidx.compose.ui.Modifier
import androidx.compose.ui.geometry.Offset
import androidx.compose.ui.graphics.Color
import androidx.compose.ui.graphics.drawscope.Stroke
import androidx.compose.ui.semantics.clearAndSetSemantics
import androidx.compose.ui.unit.dp
import org.magcomp.core.DeviceVector

/** The colours of [DirectionSphere]: the directions that are missing, where the field points now, the rim. */
public class SphereColors(public val missing: Color, public val now: Color, public val rim: Color)

/**
 * Where to turn the phone: the sphere of directions, seen along the screen's normal. The missing ones are dots, those behind it pale, and the next
 * large; the field now is a ring, which the user brings to the large dot. A screen reader hears nothing of it: give it the guidance's text.
 *
 * @param unseen `reading.unseenDirections`, in the screen's frame
 * @param pointing where the field points now, a unit vector; null: not known
 * @param next the one of [unseen] to turn to; null: none
 */
@Composable
public fun DirectionSphere(unseen: List<DeviceVector>, pointing: DeviceVector?, next: DeviceVector?, colors: SphereColors, modifier: Modifier = Modifier) {
    Canvas(modifier.clearAndSetSemantics {}) {
        val radius = size.minDimension / 2
        fun place(v: DeviceVector) = Offset(center.x + radius * v.x.toFloat(), center.y - radius * v.y.toFloat())
        fun shade(v: DeviceVector) = colors.missing.copy(alpha = if (v.z < 0) 0.3f else 1f)
        drawCircle(colors.rim, style = Stroke(1.dp.toPx()))
        for (direction in unseen) drawCircle(shade(direction), if (direction == next) 7.dp.toPx() else 3.dp.toPx(), place(direction))
        pointing?.let { drawCircle(colors.now, 8.dp.toPx(), place(it), style = Stroke(2.dp.toPx())) }
    }
}
