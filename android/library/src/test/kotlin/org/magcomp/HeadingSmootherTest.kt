package org.magcomp

import org.junit.jupiter.api.Assertions.assertEquals
import org.junit.jupiter.api.Assertions.assertThrows
import org.junit.jupiter.api.Assertions.assertTrue
import org.junit.jupiter.api.Test

class HeadingSmootherTest {
    @Test
    fun `half of a step is followed after the half-life, whatever the rate, the short way round`() {
        for (rate in listOf(10, 100)) {
            for ((from, to, half) in listOf(Triple(350.0, 30.0, 10.0), Triple(10.0, 330.0, 350.0), Triple(90.0, 100.0, 95.0))) {
                val smoother = HeadingSmoother(0.2)
                assertEquals(from, smoother.push(0, from))
                var last = from
                for (k in 1..rate / 5) last = smoother.push(k * 1_000_000_000L / rate, to)
                assertEquals(half, last, 1e-9)
            }
        }
    }

    @Test
    fun `what is not known begins anew, as a clock that was set back`() {
        val smoother = HeadingSmoother(1.0)
        smoother.push(0, 10.0)
        assertTrue(smoother.push(1, Double.NaN).isNaN())
        assertEquals(200.0, smoother.push(2, 200.0))
        assertEquals(100.0, smoother.push(1, 100.0))
        assertTrue(smoother.push(3, Double.POSITIVE_INFINITY).isNaN())
        for (halfLifeS in listOf(-1.0, Double.NaN, Double.POSITIVE_INFINITY)) {
            assertThrows(IllegalArgumentException::class.java) { HeadingSmoother(halfLifeS) }
        }
    }

    @Test
    fun `with a half-life of 0 nothing is smoothed, and 360 is 0`() {
        val smoother = HeadingSmoother(0.0)
        for ((given, shown) in listOf(10.0 to 10.0, 359.9 to 359.9, 360.0 to 0.0, -1.0 to 359.0, -1e-20 to 0.0, 725.0 to 5.0)) {
            assertEquals(shown, smoother.push(0, given))
        }
    }
}
