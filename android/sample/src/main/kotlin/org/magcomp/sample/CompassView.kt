package org.magcomp.sample

import android.content.Context
import android.graphics.Canvas
import android.graphics.Color
import android.graphics.Paint
import android.view.View
import java.util.Locale
import org.magcomp.CompensatedReading
import org.magcomp.HeadingSmoother
import org.magcomp.Reading
import org.magcomp.Vector3

/**
 * The rose, the heading with its uncertainty, the total field, the status in words, and the sphere of directions: turn the
 * phone until its dots, where the field has not pointed yet, are gone.
 */
class CompassView(context: Context) : View(context) {
    private val line = Paint(Paint.ANTI_ALIAS_FLAG).apply {
        style = Paint.Style.STROKE
        strokeWidth = 4f
        color = Color.DKGRAY
    }
    private val needle = Paint(Paint.ANTI_ALIAS_FLAG).apply {
        style = Paint.Style.STROKE
        strokeWidth = 12f
        color = Color.RED
    }
    private val doubt = Paint(Paint.ANTI_ALIAS_FLAG).apply { color = Color.argb(60, 255, 0, 0) }
    private val unseenInFront = Paint(Paint.ANTI_ALIAS_FLAG).apply { color = Color.argb(255, 0, 120, 0) }
    private val unseenBehind = Paint(Paint.ANTI_ALIAS_FLAG).apply { color = Color.argb(80, 0, 120, 0) }
    private val text = Paint(Paint.ANTI_ALIAS_FLAG).apply {
        textSize = 48f
        textAlign = Paint.Align.CENTER
        color = Color.BLACK
    }
    private var reading: Reading? = null
    private val smoother = HeadingSmoother(halfLifeS = 0.1)
    private var roseDeg = Double.NaN
    private var unseen = emptyList<Vector3>()
    private var words = "starting"

    /** Shows a reading. The words cost a call into the library, so only a changed kind of status asks for them. */
    fun show(next: CompensatedReading) {
        if (next.reading.status != reading?.status) words = next.reading.status.text()
        reading = next.reading
        roseDeg = smoother.push(next.reading.timeNs, next.reading.heading?.headingDeg ?: Double.NaN)
        unseen = next.unseenDirections
        invalidate()
    }

    /** Shows why there are no readings, and nothing of those before. */
    fun explain(why: String?) {
        words = why ?: "the end"
        reading = null
        unseen = emptyList()
        invalidate()
    }

    override fun onDraw(canvas: Canvas) {
        val (x, y) = Pair(width / 2f, height / 2.6f)
        val radius = minOf(x, y) * 0.8f
        canvas.drawColor(Color.WHITE)
        val heading = reading?.heading
        if (heading != null) {
            canvas.save()
            canvas.rotate(-roseDeg.toFloat(), x, y)
            for ((k, letter) in listOf("N", "E", "S", "W").withIndex()) {
                canvas.save()
                canvas.rotate(90f * k, x, y)
                canvas.drawText(letter, x, y - radius + 60f, text)
                canvas.restore()
            }
            val sigma = (heading.headingSigmaDeg ?: 90.0).toFloat()
            canvas.drawArc(x - radius, y - radius, x + radius, y + radius, -90f - sigma, 2 * sigma, true, doubt)
            canvas.drawLine(x, y, x, y - radius, needle)
            canvas.restore()
        }
        canvas.drawCircle(x, y, radius, line)
        val lines = listOf(
            heading?.let { degrees(it.headingDeg) + (it.headingSigmaDeg?.let { s -> " \u00b1 " + degrees(s) } ?: "") } ?: "no heading yet",
            reading?.totalFieldUt?.let { String.format(Locale.ROOT, "%.1f \u00b5T", it) } ?: "",
            words,
            "directions seen: " + String.format(Locale.ROOT, "%.0f %%", 100 * (reading?.coverage ?: 0.0)),
        )
        for ((k, words) in lines.withIndex()) canvas.drawText(words, x, y + radius + 80f + 60f * k, text)
        drawSphere(canvas, x, y + radius + 200f + 60f * lines.size, radius / 3)
    }

    /** The sphere seen along the screen's normal; the directions that are missing, those behind it pale. */
    private fun drawSphere(canvas: Canvas, x: Float, y: Float, radius: Float) {
        canvas.drawCircle(x, y, radius, line)
        for (direction in unseen) {
            val paint = if (direction.z < 0) unseenBehind else unseenInFront
            canvas.drawCircle(x + radius * direction.x.toFloat(), y - radius * direction.y.toFloat(), radius / 12, paint)
        }
    }

    private fun degrees(value: Double) = String.format(Locale.ROOT, "%.0f\u00b0", value)
}
