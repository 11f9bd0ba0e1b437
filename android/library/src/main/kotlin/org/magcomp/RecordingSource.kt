package org.magcomp

import java.io.File
import java.io.Reader
import java.util.zip.GZIPInputStream
import kotlin.math.abs
import kotlin.math.floor
import kotlinx.coroutines.currentCoroutineContext
import kotlinx.coroutines.ensureActive
import org.magcomp.core.*

/**
 * A recording is not in order.
 *
 * @property name the recording
 * @property line line in it, from 1
 * @property column column's name, or null when the line as a whole is wrong
 */
public class RecordingException(public val name: String, public val line: Int, public val column: String?, what: String) :
    CompassException("$name, line $line" + (column?.let { ", column $it" } ?: "") + ": $what")

/**
 * A recording as CSV, for tests and demos: `t_s,mx,my,mz[,ax,ay,az][,gx,gy,gz]` in any order, seconds, microtesla,
 * m/s^2 (pointing up at rest), rad/s; other columns are ignored. Every row is a gyroscope event, an `up` event and a magnetometer event, in
 * this order, as far as it has them: a row may leave all three cells of a sensor empty. A cell may stand in quotation marks. [record] and
 * `magcomp import` write such recordings.
 *
 * Collecting does not wait between rows and fails with [RecordingException] where the recording is not in order, and with
 * [java.io.IOException] when its file can't be read.
 *
 * @param name said in errors
 * @param open opens the text anew for every collector
 */
public class RecordingSource(private val name: String, private val open: () -> Reader) : MagneticFieldSource {
    /** A file, `.csv` or `.csv.gz`. */
    public constructor(file: File) : this(file.name, {
        val bytes = file.inputStream()
        (if (file.name.endsWith(".gz")) GZIPInputStream(bytes) else bytes).reader()
    })

    override suspend fun deliver(taker: EventTaker) {
        val event = RawEvent()
        open().buffered().use { lines ->
            // spreadsheets write a mark first
            val header = lines.readLine()?.removePrefix("\uFEFF") ?: throw RecordingException(name, 1, null, "the header is missing")
            val columns = Columns(header)
            var number = 1
            while (true) {
                val line = lines.readLine() ?: break
                number += 1
                if (line.isEmpty()) continue
                val row = columns.row(line, number)
                fun give(kind: Int, v: DeviceVector?) {
                    v ?: return
                    event.set(kind, row.timeNs, v.x, v.y, v.z)
                    taker.take(event)
                }
                give(RawEvent.ROTATION_RATE, row.vector("gx", "gy", "gz"))
                give(RawEvent.UP, row.vector("ax", "ay", "az"))
                give(RawEvent.MAGNETIC, row.vector("mx", "my", "mz"))
                currentCoroutineContext().ensureActive()
            }
        }
    }

    private inner class Columns(header: String) {
        val names = header.split(',').map { it.trim() }
        val index = names.withIndex().associate { it.value to it.index }

        init {
            for (column in listOf("t_s", "mx", "my", "mz")) {
                if (column !in index) throw RecordingException(name, 1, column, "the column is missing")
            }
        }

        fun row(line: String, number: Int): Row {
            val cells = cellsOf(line)
            if (cells.size != names.size) {
                throw RecordingException(name, number, null, "${cells.size} cells, expected ${names.size}")
            }
            return Row(this, cells, number)
        }
    }

    private inner class Row(val columns: Columns, val cells: List<String>, val line: Int) {
        val timeNs: Long = number("t_s").let {
            if (!(abs(it) < LARGEST_TIME_S)) {
                throw RecordingException(name, line, "t_s", "the time is no number of seconds that fits 64 bits of nanoseconds")
            }
            nearest(it * 1e9)
        }

        fun vector(x: String, y: String, z: String): DeviceVector? =
            if (listOf(x, y, z).all { it in columns.index } && listOf(x, y, z).any { cell(it).isNotEmpty() }) {
                DeviceVector(number(x), number(y), number(z))
            } else {
                null
            }

        private fun cell(column: String): String = cells[columns.index.getValue(column)].trim()

        private fun number(column: String): Double {
            val text = cell(column)
            if (text.equals("nan", ignoreCase = true)) return Double.NaN
            return text.toDoubleOrNull() ?: throw RecordingException(name, line, column, "'$text' is no number")
        }
    }

    private companion object {
        /** A cell in quotation marks, in which one that is meant stands twice, or any other. */
        val CELL = Regex("\"((?:[^\"]|\"\")*)\"(?=,|$)|[^,]*")

        /** One more cell begins behind every comma. */
        fun cellsOf(line: String): List<String> {
            if ('"' !in line) return line.split(',')
            val cells = ArrayList<String>()
            var at = 0
            while (at <= line.length) {
                val cell = CELL.find(line, at)!!
                cells += cell.groups[1]?.value?.replace("\"\"", "\"") ?: cell.value
                at = cell.range.last + 2
            }
            return cells
        }

        /** Times beyond this do not fit 64-bit nanoseconds. */
        const val LARGEST_TIME_S = 9e9

        /** Halves away from 0, as Rust rounds. */
        fun nearest(value: Double): Long = (if (value < 0) -floor(-value + 0.5) else floor(value + 0.5)).toLong()
    }
}
