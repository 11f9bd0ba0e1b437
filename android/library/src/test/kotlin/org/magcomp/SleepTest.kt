package org.magcomp

import kotlin.time.Duration.Companion.ZERO
import kotlinx.coroutines.flow.flow
import kotlinx.coroutines.flow.toList
import kotlinx.coroutines.runBlocking
import org.junit.jupiter.api.Assertions.assertEquals
import org.junit.jupiter.api.Test

class SleepTest {
    private val second = 1_000_000_000L

    @Test
    fun `a lag that becomes less is no sleep, one that becomes more is`() {
        val sleep = Sleep()
        fun see(fromS: Int, lagS: Long) = repeat(200) { k -> ((fromS * 100L + k) * second / 100).let { sleep.see(it, it + lagS * second) } }
        see(0, lagS = 10)
        see(2, lagS = 0)
        assertEquals(Pair(0.0, 0L), Pair(sleep.hiddenS, sleep.behindNs))
        see(4, lagS = 60)
        assertEquals(60.0, sleep.hiddenS, 1e-6)
        assertEquals(60 * second, sleep.behindNs)
    }

    @Test
    fun `sleep before a compass is made is none of its own`() = runBlocking {
        val source = object : FlowSource() {
            override val hiddenS = 3600.0

            override fun played() = flow { events(tumbling(50)).forEach { emit(it) } }
        }
        val compass = Compass(source, grace = ZERO)
        compass.readings().toList()
        assertEquals(0L, compass.kept!!.compensator.gaps())
        compass.close()
    }
}
