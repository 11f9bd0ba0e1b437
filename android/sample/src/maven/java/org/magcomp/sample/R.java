package org.magcomp.sample;

/** Stands in for the class that Android's tools make of the resources; a test compares the names. */
final class R {
    static final class string {
        static int app_name = 0x7f0f0000;
        static int heading = 0x7f0f0001;
        static int no_heading = 0x7f0f0002;
        static int true_heading = 0x7f0f0003;
        static int system_heading = 0x7f0f0004;
        static int field = 0x7f0f0005;
        static int seen = 0x7f0f0006;
        static int next = 0x7f0f0007;
        static int over = 0x7f0f0008;
        static int course_on = 0x7f0f000e;
        static int course_off = 0x7f0f000f;
        static int record_on = 0x7f0f0010;
        static int record_off = 0x7f0f0011;
        static int recorded = 0x7f0f0012;
        static int not_recorded = 0x7f0f0013;
        static int share = 0x7f0f0014;
        static int north = 0x7f0f0009;
        static int east = 0x7f0f000a;
        static int south = 0x7f0f000b;
        static int west = 0x7f0f000c;
    }
}
