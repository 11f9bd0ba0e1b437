package org.magcomp

import java.io.File
import java.io.OutputStream
import java.util.zip.GZIPOutputStream
import kotlinx.coroutines.Dispatchers
import kotlinx.coroutines.flow.first
import kotlinx.coroutines.withContext

/**
 * Writes the raw events of a source to a file until it is cancelled, the source ends, or [mostBytes] are written: `magcomp replay` reads
 * it, and [RecordingSource] plays it. It holds no compass up: it takes part in the sensors as another collector does.
 *
 * The columns are `t_s` (seconds since the first event), `mx,my,mz` (raw field, microtesla), `sys_mx,sys_my,sys_mz` (the field as the
 * system corrects it, microtesla), `ax,ay,az` (gravity or acceleration, m/s^2, pointing up at rest), `gx,gy,gz` (rad/s). Every event is a
 * row of its own, at its own time, with the other sensors' cells empty; those of one time share a row. No place and no date is in it.
 *
 * @param file a `.csv`, or a `.csv.gz`, which is a third as large; what it holds already is lost
 * @param mostBytes the size of the text, before it is packed, at which the file ends, at least 1000. Default 100 MB, about two hours at
 *   100 Hz
 * @return the events that were written. One whose time is not after the one before, of the same sensor, is left out
 * @throws java.io.IOException when the file can't be written; what was written before stays
 */
public suspend fun MagneticFieldSource.record(file: File, mostBytes: Long = 100_000_000): Long = withContext(Dispatchers.IO) {
    require(mostBytes >= 1000) { "mostBytes is $mostBytes, expected at least 1000" }
    val bytes = file.outputStream().buffered()
    (if (file.name.endsWith(".gz")) GZIPOutputStream(bytes) else bytes).use { out ->
        val rows = Rows(out, mostBytes)
        try {
            samples().first { !rows.write(it) }
        } catch (_: NoSuchElementException) {
            // the source has ended
        } finally {
            rows.end()
        }
        rows.events
    }
}

/** The rows of a recording, the one that is not complete yet aside. */
private class Rows(private val out: OutputStream, private val mostBytes: Long) {
    var events = 0L
        private set
    private var bytes = 0L
    private var firstNs: Long? = null
    private var rowNs = 0L
    private val cells = arrayOfNulls<String>(GROUPS)

    init {
        line("t_s,mx,my,mz,sys_mx,sys_my,sys_mz,ax,ay,az,gx,gy,gz")
    }

    /** Whether there is room for more. */
    fun write(event: SensorSample): Boolean {
        val isFirst = firstNs == null
        if (isFirst) firstNs = event.timeNs
        if (isFirst || event.timeNs > rowNs) {
            if (!isFirst) row()
            rowNs = event.timeNs
        }
        val group = when (event) {
            is SensorSample.Magnetic -> MAGNETIC
            is SensorSample.Up -> UP
            is SensorSample.RotationRate -> RATE
        }
        if (event.timeNs < rowNs || cells[group] != null) return true
        when (event) {
            is SensorSample.Magnetic -> {
                val field = event.sample.fieldUt
                cells[group] = text(field)
                event.sample.reportedHardIronUt?.let { cells[SYSTEM] = text(DeviceVector(field.x - it.x, field.y - it.y, field.z - it.z)) }
            }
            is SensorSample.Up -> cells[group] = text(event.sample.upMS2)
            is SensorSample.RotationRate -> cells[group] = text(event.sample.rateRadS)
        }
        events += 1
        return bytes < mostBytes - LONGEST_ROW
    }

    fun end() {
        if (cells.any { it != null }) row()
    }

    private fun row() {
        // a difference of two times of one clock; the first is the earliest
        val ns = rowNs - firstNs!!
        line("${ns / NS}.${(ns % NS).toString().padStart(9, '0')},${cells.joinToString(",") { it ?: ",," }}")
        cells.fill(null)
    }

    /** As a phone's sensors measure, in floats. */
    private fun text(v: DeviceVector) = "${v.x.toFloat()},${v.y.toFloat()},${v.z.toFloat()}"

    private fun line(text: String) {
        val line = "$text\n".toByteArray(Charsets.US_ASCII)
        out.write(line)
        bytes += line.size
    }

    private companion object {
        const val GROUPS = 4
        const val MAGNETIC = 0
        const val SYSTEM = 1
        const val UP = 2
        const val RATE = 3
        const val NS = 1_000_000_000L

        /** 12 numbers and a time. */
        const val LONGEST_ROW = 200
    }
}
