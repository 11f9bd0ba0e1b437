package org.magcomp.compose

import androidx.compose.foundation.layout.size
import androidx.compose.runtime.Composable
import androidx.compose.ui.ImageComposeScene
import androidx.compose.ui.Modifier
import androidx.compose.ui.graphics.Color
import androidx.compose.ui.unit.Density
import androidx.compose.ui.unit.dp
import androidx.compose.ui.use
import javax.imageio.ImageIO
import kotlin.math.cos
import kotlin.math.sin
import org.jetbrains.skia.EncodedImageFormat
import org.junit.jupiter.api.Assertions.assertEquals
import org.junit.jupiter.api.Test

class ConeTest {
    /** Whether it has ink in a direction from its middle, degrees clockwise from the top. */
    private fun drawn(content: @Composable () -> Unit): (Double) -> Boolean {
        val png = ImageComposeScene(200, 200, Density(1f)).use { scene ->
            scene.setContent { content() }
            scene.render().encodeToData(EncodedImageFormat.PNG)!!.bytes
        }
        val image = ImageIO.read(png.inputStream())
        return { deg -> Math.toRadians(deg).let { a -> image.getRGB((100 + 80 * sin(a)).toInt(), (100 - 80 * cos(a)).toInt()) ushr 24 != 0 } }
    }

    @Test
    fun `the number, the cone and the rose say the same uncertainty`() {
        for ((sigmaDeg, shown) in mapOf(0.0 to 0, 12.4 to 13, 13.0 to 13, 179.2 to 180, 400.0 to 180, null to 180, Double.NaN to 180, -1.0 to 180)) {
            assertEquals(shown, shownSigmaDeg(sigmaDeg), "$sigmaDeg")
            if (shown !in 1..170) continue
            val cone = drawn { HeadingCone(70.0, sigmaDeg, Color.Red, Modifier.size(200.dp)) }
            assertEquals(listOf(false, true, true, true, false), listOf(-shown - 1.5, 1.5 - shown, 0.0, shown - 1.5, shown + 1.5).map { cone(70 + it) })
            val colors = RoseColors(Color.Red, Color.Transparent, Color.Transparent)
            val rose = drawn { CompassRose(70.0, sigmaDeg, "", colors, Modifier.size(200.dp), List(4) { "" }) }
            assertEquals(listOf(false, true, true, true, false), listOf(-shown - 1.5, 1.5 - shown, 0.0, shown - 1.5, shown + 1.5).map { rose(it - 70) })
        }
    }

    @Test
    fun `a cone that knows nothing of its width is a disc, and one without a heading is none`() {
        val all = (0 until 360 step 10).map { it.toDouble() }
        assertEquals(all, all.filter(drawn { HeadingCone(70.0, null, Color.Red, Modifier.size(200.dp)) }))
        for (none in listOf(null, Double.NaN)) {
            assertEquals(emptyList<Double>(), all.filter(drawn { HeadingCone(none, 10.0, Color.Red, Modifier.size(200.dp)) }))
        }
    }
}
