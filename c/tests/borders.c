/* What is refused, with which error, and that it changes nothing. */
#include <limits.h>
#include <magcomp.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define CHECK(condition) ((condition) ? (void)0 : fail(__LINE__, #condition))
/* the call comes before its message is read */
#define REFUSED(expected, says, call)                                                                                     \
    do {                                                                                                                  \
        const magcomp_error code_ = (call);                                                                               \
        refused(__LINE__, #call, MAGCOMP_ERROR_##expected, code_, magcomp_compensator_last_error(c), says);               \
    } while (0)

static void fail(int line, const char *what) {
    fprintf(stderr, "borders.c:%d: not so: %s\n", line, what);
    exit(1);
}

static void refused(int line, const char *call, magcomp_error expected, magcomp_error code, const char *message, const char *says) {
    if (code == expected && strstr(message, says) != NULL) return;
    fprintf(stderr, "borders.c:%d: %s answered %d, \"%s\"; expected %d, \"...%s...\"\n", line, call, code, message, expected, says);
    exit(1);
}

static const int64_t STEP_NS = 10000000;
static const double B_UT[3] = {20, -30, 40};

static magcomp_compensator *made(const char *config) {
    magcomp_compensator *c;
    CHECK(magcomp_compensator_create(config, &c) == MAGCOMP_ERROR_NONE && c != NULL);
    return c;
}

static magcomp_reading pushed(magcomp_compensator *c, int64_t time_ns, double x, double y, double z) {
    magcomp_reading reading = {.size = sizeof reading};
    CHECK(magcomp_compensator_push(c, time_ns, x, y, z, &reading) == MAGCOMP_ERROR_NONE);
    CHECK(reading.size == sizeof reading && reading.time_ns == time_ns);
    return reading;
}

/* A device with the hard iron B_UT that is turned to every side, gravity beside it. */
static magcomp_reading turned(magcomp_compensator *c, int first, int count) {
    magcomp_reading reading = {.size = 0};
    for (int k = first; k < first + count; k++) {
        const double a = 0.031 * k, b = 0.023 * k; /* attitude: about z, then about x */
        const double east[2] = {cos(a), -sin(a)};
        const double noise = 0.2 * sin(1.7 * k * k);
        (void)magcomp_compensator_push_up(c, k * STEP_NS, 0.0, 9.81 * sin(b), 9.81 * cos(b));
        /* north 22 uT, down 42 uT */
        const double level[3] = {22 * -east[1], 22 * east[0], -42};
        reading = pushed(c, k * STEP_NS, level[0] + B_UT[0] + noise, level[1] * cos(b) + level[2] * sin(b) + B_UT[1],
                         -level[1] * sin(b) + level[2] * cos(b) + B_UT[2] - noise);
    }
    return reading;
}

static void configs(void) {
    magcomp_compensator *const c = NULL; /* REFUSED reads this thread's message */
    magcomp_compensator *out;
    static const struct {
        const char *text, *says;
    } bad[] = {
        {"", "EOF"},
        {"{", "EOF"},
        {"[3]", "config: "},
        {"nonsense", "config: "},
        {"\xff\xfe", "not UTF-8"},
        {"{\"rail\": 3}", "unknown field `rail`"},
        {"{\"a\\u0000b\": 3}", "unknown field"},
        {"{\"rail_ut\": -1}", "rail_ut is -1.0, expected 1.0 to 100000.0 uT"},
        {"{\"rail_ut\": 1e999}", "number out of range"},
        {"{\"rail_ut\": NaN}", "config: "},
        {"{\"method\": \"Best\"}", "unknown variant `Best`"},
        {"{\"heading\": {\"declination_deg\": 500}}", "declination_deg"},
        {"{\"windowed\": {\"n_max\": 99999999999}}", "n_max"},
        {"{\"initial\": {\"soft_iron\": [0,0,0,0,0,0,0,0,0], \"hard_iron_ut\": [0,0,0], \"field_strength_ut\": 50}}", "soft iron"},
    };
    for (size_t k = 0; k < sizeof bad / sizeof *bad; k++) {
        out = (magcomp_compensator *)&out;
        REFUSED(CONFIG, bad[k].says, magcomp_compensator_create(bad[k].text, &out));
        CHECK(out == NULL);
    }
    char deep[20001];
    memset(deep, '[', sizeof deep - 1);
    deep[sizeof deep - 1] = 0;
    REFUSED(CONFIG, "config: ", magcomp_compensator_create(deep, &out));
    REFUSED(NULL_POINTER, "compensator is a null pointer", magcomp_compensator_create(NULL, NULL));
}

/* The settings as members. */
static void typed_configs(void) {
    magcomp_compensator *c = NULL; /* REFUSED reads this thread's message */
    magcomp_compensator *out;
    magcomp_config config = {.size = sizeof config};
    CHECK(magcomp_config_default(&config) == MAGCOMP_ERROR_NONE && config.size == sizeof config);
    CHECK(config.method == MAGCOMP_METHOD_AUTO && config.axis == MAGCOMP_AXIS_TOP_EDGE && config.screen_rotation_deg == 0);
    CHECK(config.range_ut == 2000 && isnan(config.rail_ut) && isnan(config.field_strength_ut) && isnan(config.declination_deg));
    CHECK(config.tilt_sigma_deg == 0.5);
    const magcomp_config usual = config;
    CHECK(magcomp_config_default(NULL) == MAGCOMP_ERROR_NULL_POINTER);
    config.size = offsetof(magcomp_config, tilt_sigma_deg);
    CHECK(magcomp_config_default(&config) == MAGCOMP_ERROR_SIZE);
    REFUSED(SIZE, "magcomp_config", magcomp_compensator_create_with(&config, &out));
    CHECK(out == NULL);
    REFUSED(NULL_POINTER, "magcomp_config", magcomp_compensator_create_with(NULL, &out));
    REFUSED(NULL_POINTER, "compensator", magcomp_compensator_create_with(&usual, NULL));

    /* every member is checked */
#define REFUSED_WITH(member, value, says)                                                \
    do {                                                                                 \
        config = usual;                                                                  \
        config.member = (value);                                                         \
        out = (magcomp_compensator *)&out;                                               \
        REFUSED(CONFIG, says, magcomp_compensator_create_with(&config, &out));           \
        CHECK(out == NULL);                                                              \
    } while (0)
    REFUSED_WITH(method, 4, "method is 4");
    REFUSED_WITH(method, -1, "method is -1");
    REFUSED_WITH(axis, 3, "axis is 3");
    REFUSED_WITH(screen_rotation_deg, 45, "screen_rotation_deg is 45, expected 0, 90, 180 or 270");
    REFUSED_WITH(range_ut, 0.5, "range_ut is 0.5, expected 1.0 to 100000.0 uT");
    REFUSED_WITH(range_ut, NAN, "range_ut is NaN");
    REFUSED_WITH(rail_ut, INFINITY, "rail_ut is inf");
    REFUSED_WITH(field_strength_ut, 1001, "field_strength_ut is 1001.0");
    REFUSED_WITH(declination_deg, -181, "declination_deg is -181.0");
    REFUSED_WITH(tilt_sigma_deg, 91, "tilt_sigma_deg is 91.0");

    /* and does what that of the text does */
    static const struct {
        const char *text;
        double range_ut, rail_ut, field_strength_ut, declination_deg, tilt_sigma_deg;
        magcomp_method method;
        magcomp_axis axis;
        int32_t screen_rotation_deg;
    } same[] = {
        {"{\"method\": \"Adaptive\", \"heading\": {\"axis\": \"Camera\", \"declination_deg\": 2.5}}", 2000, NAN, NAN, 2.5, 0.5, MAGCOMP_METHOD_ADAPTIVE, MAGCOMP_AXIS_CAMERA, 0},
        {"{\"field_strength_ut\": 48, \"heading\": {\"axis\": \"Auto\", \"screen_rotation\": \"Deg270\", \"tilt_sigma_deg\": 3}}", 2000, NAN, 48, NAN, 3, MAGCOMP_METHOD_AUTO, MAGCOMP_AXIS_AUTO, 270},
        {"{\"method\": \"Windowed\", \"range_ut\": 90, \"heading\": {\"screen_rotation\": \"Deg180\"}}", 90, NAN, NAN, NAN, 0.5, MAGCOMP_METHOD_WINDOWED, MAGCOMP_AXIS_TOP_EDGE, 180},
        {"{\"method\": \"Constant\", \"rail_ut\": 80, \"heading\": {\"screen_rotation\": \"Deg90\"}}", 2000, 80, NAN, NAN, 0.5, MAGCOMP_METHOD_CONSTANT, MAGCOMP_AXIS_TOP_EDGE, 90},
    };
    for (size_t k = 0; k < sizeof same / sizeof *same; k++) {
        c = made(same[k].text);
        config = usual;
        config.method = same[k].method;
        config.axis = same[k].axis;
        config.screen_rotation_deg = same[k].screen_rotation_deg;
        config.range_ut = same[k].range_ut;
        config.rail_ut = same[k].rail_ut;
        config.field_strength_ut = same[k].field_strength_ut;
        config.declination_deg = same[k].declination_deg;
        config.tilt_sigma_deg = same[k].tilt_sigma_deg;
        CHECK(magcomp_compensator_create_with(&config, &out) == MAGCOMP_ERROR_NONE);
        const magcomp_reading by_text = turned(c, 0, 3000), by_members = turned(out, 0, 3000);
        CHECK(memcmp(&by_text, &by_members, sizeof by_text) == 0);
        magcomp_compensator_free(c);
        magcomp_compensator_free(out);
    }

    /* of set_heading: what is no heading's is not read */
    c = made(NULL);
    (void)turned(c, 0, 3000);
    config = usual;
    config.method = 99;
    config.range_ut = NAN;
    config.declination_deg = 5;
    CHECK(magcomp_compensator_set_heading_with(c, &config) == MAGCOMP_ERROR_NONE);
    const magcomp_reading r = turned(c, 3000, 1);
    CHECK(fabs(remainder(r.true_heading_deg - r.heading_deg - 5, 360)) < 1e-9);
    config.tilt_sigma_deg = -1;
    REFUSED(CONFIG, "tilt_sigma_deg", magcomp_compensator_set_heading_with(c, &config));
    REFUSED(NULL_POINTER, "magcomp_config", magcomp_compensator_set_heading_with(c, NULL));
    CHECK(isfinite(turned(c, 3001, 1).true_heading_deg));
    magcomp_compensator_free(c);
    c = NULL;
    REFUSED(NULL_POINTER, "compensator", magcomp_compensator_set_heading_with(c, &usual));
}

static void nulls(void) {
    magcomp_compensator *c = NULL;
    magcomp_reading reading = {.size = sizeof reading};
    magcomp_calibration calibration = {.size = sizeof calibration};
    const char *text = NULL;
    const char *says = "compensator is a null pointer";
    REFUSED(NULL_POINTER, says, magcomp_compensator_push(c, 0, 1, 2, 3, &reading));
    REFUSED(NULL_POINTER, says, magcomp_compensator_push_rotation_rate(c, 0, 1, 2, 3));
    REFUSED(NULL_POINTER, says, magcomp_compensator_push_up(c, 0, 1, 2, 3));
    REFUSED(NULL_POINTER, says, magcomp_compensator_push_heading(c, 0, 90, 5, MAGCOMP_NORTH_TRUE, NULL));
    REFUSED(NULL_POINTER, says, magcomp_compensator_push_attitude(c, 0, 1, 0, 0, 0, MAGCOMP_NORTH_NONE, 0));
    REFUSED(NULL_POINTER, says, magcomp_compensator_found_declination(c, NULL, NULL));
    CHECK(magcomp_compensator_heading_aid(c) == MAGCOMP_HEADING_AID_NONE);
    REFUSED(NULL_POINTER, says, magcomp_compensator_push_gap(c, 1));
    REFUSED(NULL_POINTER, says, magcomp_compensator_reset(c));
    REFUSED(NULL_POINTER, says, magcomp_compensator_set_heading(c, NULL));
    REFUSED(NULL_POINTER, says, magcomp_compensator_calibration(c, &calibration));
    REFUSED(NULL_POINTER, says, magcomp_compensator_adopt_calibration(c, &calibration, 1));
    REFUSED(NULL_POINTER, says, magcomp_compensator_keep(c, 0, &text));
    REFUSED(NULL_POINTER, says, magcomp_compensator_adopt(c, "{}", 0));
    CHECK(strcmp(magcomp_compensator_status_text(c), "") == 0);
    magcomp_compensator_free(c);

    c = made(NULL);
    CHECK(strcmp(magcomp_compensator_last_error(c), "") == 0);
    CHECK(strcmp(magcomp_compensator_status_text(c), "") == 0);
    REFUSED(NULL_POINTER, "magcomp_reading", magcomp_compensator_push(c, 0, 1, 2, 3, NULL));
    REFUSED(NULL_POINTER, "magcomp_calibration", magcomp_compensator_calibration(c, NULL));
    REFUSED(NULL_POINTER, "magcomp_calibration", magcomp_compensator_adopt_calibration(c, NULL, 1));
    REFUSED(NULL_POINTER, "kept_json", magcomp_compensator_keep(c, 0, NULL));
    REFUSED(NULL_POINTER, "kept_json", magcomp_compensator_adopt(c, NULL, 0));
    /* errors of this compensator are not this thread's, and a call that succeeds leaves them */
    CHECK(strstr(magcomp_compensator_last_error(NULL), "kept_json") == NULL);
    pushed(c, 0, 20, 0, 40);
    CHECK(strstr(magcomp_compensator_last_error(c), "kept_json") != NULL);
    magcomp_compensator_free(c);
}

static void sizes(void) {
    magcomp_compensator *c = made(NULL);
    magcomp_reading reading;
    magcomp_calibration calibration;
    const size_t bad[] = {0, 8, sizeof reading - 1, 4097, SIZE_MAX};
    for (size_t k = 0; k < sizeof bad / sizeof *bad; k++) {
        memset(&reading, 0xa5, sizeof reading);
        const magcomp_reading before = reading;
        reading.size = bad[k];
        REFUSED(SIZE, "sizeof(magcomp_reading), 240", magcomp_compensator_push(c, 0, 20, 0, 40, &reading));
        CHECK(memcmp(&reading.time_ns, &before.time_ns, sizeof reading - sizeof reading.size) == 0);
        calibration.size = bad[k] == sizeof reading - 1 ? sizeof calibration - 1 : bad[k];
        REFUSED(SIZE, "sizeof(magcomp_calibration), 112", magcomp_compensator_calibration(c, &calibration));
        REFUSED(SIZE, "sizeof(magcomp_calibration), 112", magcomp_compensator_adopt_calibration(c, &calibration, 2));
    }
    /* the samples of those calls were not used: their time is still to come */
    CHECK(pushed(c, 0, 20, 0, 40).status == MAGCOMP_STATUS_COLLECTING);
    CHECK(pushed(c, 0, 20, 0, 40).reason == MAGCOMP_REASON_TIME_NOT_AFTER);

    /* a caller of a later version: what this one does not know stays as it was, and the caller can tell */
    struct {
        magcomp_reading known;
        unsigned char later[64];
    } grown;
    memset(&grown, 0xa5, sizeof grown);
    grown.known.size = sizeof grown;
    CHECK(magcomp_compensator_push(c, STEP_NS, 20, 0, 40, &grown.known) == MAGCOMP_ERROR_NONE);
    CHECK(grown.known.size == sizeof(magcomp_reading) && grown.known.time_ns == STEP_NS);
    for (size_t k = 0; k < sizeof grown.later; k++) CHECK(grown.later[k] == 0xa5);
    magcomp_compensator_free(c);
}

static void samples(void) {
    magcomp_compensator *c = made("{\"rail_ut\": 1200}");
    magcomp_reading r = pushed(c, 0, NAN, 0, 0);
    CHECK(r.status == MAGCOMP_STATUS_REJECTED && r.reason == MAGCOMP_REASON_NOT_FINITE && r.fit_problem == MAGCOMP_FIT_PROBLEM_NONE);
    CHECK(isnan(r.field_ut[0]) && isnan(r.total_field_ut) && isnan(r.heading_deg) && isnan(r.attitude[3]));
    CHECK(r.event == MAGCOMP_EVENT_NONE && r.model_order == MAGCOMP_MODEL_ORDER_NONE && r.mode == MAGCOMP_MODE_MAGNETOMETER_ONLY);
    CHECK(strcmp(magcomp_compensator_status_text(c), "rejected: field is not finite") == 0);
    CHECK(pushed(c, 0, 0, -INFINITY, 0).reason == MAGCOMP_REASON_NOT_FINITE);
    CHECK(pushed(c, 0, 0, 1300, 0).reason == MAGCOMP_REASON_SATURATED);
    r = pushed(c, STEP_NS, 20, 0, 40);
    CHECK(r.status == MAGCOMP_STATUS_COLLECTING && r.reason == MAGCOMP_REASON_SAMPLES);
    CHECK(pushed(c, 0, 20, 0, 41).reason == MAGCOMP_REASON_TIME_NOT_AFTER);
    CHECK(pushed(c, INT64_MIN, 20, 0, 41).reason == MAGCOMP_REASON_TIME_NOT_AFTER);
    CHECK(pushed(c, INT64_MAX, 20, 0, 41).reason == MAGCOMP_REASON_TIME_JUMP);
    CHECK(pushed(c, 2 * STEP_NS, 20, 0, 41).status == MAGCOMP_STATUS_COLLECTING);

    REFUSED(EVENT_NOT_FINITE, "not finite", magcomp_compensator_push_rotation_rate(c, 3 * STEP_NS, NAN, 0, 0));
    REFUSED(EVENT_NOT_FINITE, "not finite", magcomp_compensator_push_up(c, 3 * STEP_NS, 0, INFINITY, 0));
    REFUSED(EVENT_OUT_OF_RANGE, "range", magcomp_compensator_push_rotation_rate(c, 3 * STEP_NS, 0, 0, 1e9));
    REFUSED(EVENT_OUT_OF_RANGE, "range", magcomp_compensator_push_up(c, 3 * STEP_NS, 0, 0, 1e9));
    REFUSED(EVENT_AHEAD, "another clock", magcomp_compensator_push_up(c, INT64_MAX, 0, 0, 9.81));
    CHECK(magcomp_compensator_push_up(c, 3 * STEP_NS, 0, 0, 9.81) == MAGCOMP_ERROR_NONE);
    REFUSED(EVENT_DUPLICATE, "same time", magcomp_compensator_push_up(c, 3 * STEP_NS, 0, 0, 9.81));
    for (int k = 4; k < 8; k++) {
        CHECK(magcomp_compensator_push_rotation_rate(c, k * STEP_NS, 0, 0, 1) == MAGCOMP_ERROR_NONE);
        CHECK(pushed(c, k * STEP_NS, 20, 0, 40 + k).status == MAGCOMP_STATUS_COLLECTING);
    }
    REFUSED(EVENT_LATE, "older", magcomp_compensator_push_rotation_rate(c, 5 * STEP_NS, 0, 0, 1));
    REFUSED(EVENT_LATE, "older", magcomp_compensator_push_rotation_rate(c, INT64_MIN, 0, 0, 1));
    magcomp_compensator_free(c);
    c = made("{\"range_ut\": 900}");
    CHECK(pushed(c, 0, 0, 0, 1000).reason == MAGCOMP_REASON_OUT_OF_RANGE);
    CHECK(strstr(magcomp_compensator_status_text(c), "1000.0 uT is outside +-900.0 uT") != NULL);
    magcomp_compensator_free(c);
}

static void gaps(void) {
    magcomp_compensator *c = made(NULL);
    const double bad[] = {-1, NAN, INFINITY, 1e10};
    for (size_t k = 0; k < sizeof bad / sizeof *bad; k++) REFUSED(CONFIG, "hidden_s", magcomp_compensator_push_gap(c, bad[k]));
    magcomp_reading r = turned(c, 0, 3000);
    CHECK(r.status == MAGCOMP_STATUS_TRACKING);
    CHECK(magcomp_compensator_push_gap(c, 3600) == MAGCOMP_ERROR_NONE);
    const magcomp_reading later = turned(c, 3000, 1);
    CHECK(later.status == MAGCOMP_STATUS_HELD && later.field_sigma_ut > r.field_sigma_ut);
    magcomp_compensator_free(c);
}

static void calibrations(void) {
    magcomp_compensator *c = made(NULL);
    magcomp_calibration found = {.size = sizeof found}, back = {.size = sizeof back};
    const char *kept = "";
    REFUSED(NOTHING_YET, "no calibration yet", magcomp_compensator_calibration(c, &found));
    REFUSED(NOTHING_YET, "no learned calibration yet", magcomp_compensator_keep(c, 0, &kept));
    CHECK(kept == NULL);
    CHECK(turned(c, 0, 3000).status == MAGCOMP_STATUS_TRACKING);
    CHECK(magcomp_compensator_calibration(c, &found) == MAGCOMP_ERROR_NONE);
    for (int axis = 0; axis < 3; axis++) CHECK(fabs(found.hard_iron_ut[axis] - B_UT[axis]) < 1);
    CHECK(found.soft_iron[1] == found.soft_iron[3] && fabs(found.soft_iron[0] - 1) < 0.05 && fabs(found.field_strength_ut - hypot(22, 42)) < 3);

    /* numbers */
    magcomp_compensator *second = made("{\"heading\": {\"declination_deg\": -3}}");
    CHECK(magcomp_compensator_adopt_calibration(second, &found, 2) == MAGCOMP_ERROR_NONE);
    CHECK(magcomp_compensator_calibration(second, &back) == MAGCOMP_ERROR_NONE);
    CHECK(memcmp(&found, &back, sizeof back) == 0);
    magcomp_reading r = turned(second, 0, 10);
    CHECK(r.status == MAGCOMP_STATUS_HELD && fabs(r.total_field_ut - found.field_strength_ut) < 3);
    CHECK(fabs(remainder(r.true_heading_deg - r.heading_deg + 3, 360)) < 1e-9);
    {
        magcomp_compensator *const c_kept = c;
        c = second; /* REFUSED reads its message */
        magcomp_calibration before = {.size = sizeof before};
        CHECK(magcomp_compensator_calibration(c, &before) == MAGCOMP_ERROR_NONE);
        magcomp_calibration bad = found;
        memset(bad.soft_iron, 0, sizeof bad.soft_iron);
        REFUSED(CALIBRATION, "positive definite", magcomp_compensator_adopt_calibration(c, &bad, 2));
        bad = found;
        bad.soft_iron[1] += 0.5;
        REFUSED(CALIBRATION, "P of M = P R", magcomp_compensator_adopt_calibration(c, &bad, 2));
        bad = found;
        bad.hard_iron_ut[2] = NAN;
        REFUSED(CALIBRATION, "not finite", magcomp_compensator_adopt_calibration(c, &bad, 2));
        bad = found;
        bad.field_strength_ut = -5;
        REFUSED(CALIBRATION, "field strength is -5", magcomp_compensator_adopt_calibration(c, &bad, 2));
        REFUSED(CONFIG, "hard_iron_sigma_ut", magcomp_compensator_adopt_calibration(c, &found, 0));
        REFUSED(CONFIG, "hard_iron_sigma_ut", magcomp_compensator_adopt_calibration(c, &found, NAN));
        CHECK(magcomp_compensator_calibration(c, &back) == MAGCOMP_ERROR_NONE);
        CHECK(memcmp(&before, &back, sizeof back) == 0);
        c = c_kept;
    }
    magcomp_compensator_free(second);

    /* a text */
    CHECK(magcomp_compensator_keep(c, 1795560000, &kept) == MAGCOMP_ERROR_NONE);
    char text[8192];
    CHECK(strlen(kept) < sizeof text - 1);
    strcpy(text, kept);
    magcomp_compensator_free(c);
    c = made(NULL);
    const int64_t times[] = {1795560000, MAGCOMP_TIME_UNKNOWN, INT64_MAX, 0};
    for (size_t k = 0; k < sizeof times / sizeof *times; k++) {
        CHECK(magcomp_compensator_adopt(c, text, times[k]) == MAGCOMP_ERROR_NONE);
        CHECK(magcomp_compensator_calibration(c, &back) == MAGCOMP_ERROR_NONE);
        CHECK(memcmp(&found, &back, sizeof back) == 0);
        if (k == 1) {
            CHECK(magcomp_compensator_reset(c) == MAGCOMP_ERROR_NONE);
            REFUSED(NOTHING_YET, "", magcomp_compensator_calibration(c, &back));
        }
    }
    /* without a time it is believed less */
    double sigma_ut[2];
    for (int k = 0; k < 2; k++) {
        CHECK(magcomp_compensator_reset(c) == MAGCOMP_ERROR_NONE);
        CHECK(magcomp_compensator_adopt(c, text, times[k]) == MAGCOMP_ERROR_NONE);
        sigma_ut[k] = turned(c, 0, 1).field_sigma_ut;
    }
    CHECK(sigma_ut[1] > 2 * sigma_ut[0]);
    CHECK(magcomp_compensator_reset(c) == MAGCOMP_ERROR_NONE);
    CHECK(magcomp_compensator_adopt(c, text, 1795560000) == MAGCOMP_ERROR_NONE);
    REFUSED(KEPT_NEWER, "version 99", magcomp_compensator_adopt(c, "{\"magcomp_calibration\": 99}", 0));
    REFUSED(KEPT_DAMAGED, "damaged", magcomp_compensator_adopt(c, "", 0));
    REFUSED(CONFIG, "not UTF-8", magcomp_compensator_adopt(c, "\xc3\x28", 0));
    for (size_t length = strlen(text) - 1; length > 0; length /= 2) {
        text[length] = 0;
        REFUSED(KEPT_DAMAGED, "damaged", magcomp_compensator_adopt(c, text, 0));
    }
    r = turned(c, 0, 1);
    CHECK(r.status == MAGCOMP_STATUS_HELD && isfinite(r.heading_deg) && isfinite(r.heading_sigma_deg));
    magcomp_compensator_free(c);
}

static void headings(void) {
    magcomp_compensator *c = made(NULL);
    magcomp_reading r = turned(c, 0, 3000);
    CHECK(isfinite(r.heading_deg) && isnan(r.true_heading_deg));
    REFUSED(CONFIG, "tilt_sigma_deg", magcomp_compensator_set_heading(c, "{\"declination_deg\": 5, \"tilt_sigma_deg\": 91}"));
    REFUSED(CONFIG, "unknown field `method`", magcomp_compensator_set_heading(c, "{\"method\": \"Auto\"}"));
    CHECK(isnan(turned(c, 3000, 1).true_heading_deg));
    CHECK(magcomp_compensator_set_heading(c, "{\"declination_deg\": 5}") == MAGCOMP_ERROR_NONE);
    r = turned(c, 3001, 1);
    CHECK(fabs(remainder(r.true_heading_deg - r.heading_deg - 5, 360)) < 1e-9);
    CHECK(magcomp_compensator_set_heading(c, NULL) == MAGCOMP_ERROR_NONE);
    CHECK(isnan(turned(c, 3002, 1).true_heading_deg));
    magcomp_compensator_free(c);
}

/* A device that lies flat and still, its top edge north by a calibration that is hardly known; headings say it points elsewhere. */
static void from_outside(void) {
    magcomp_compensator *c = made(NULL);
    const double top[3] = {0, 1, 0}, zero[3] = {0, 0, 0};
    double declination_deg = 1, sigma_deg = 1;
    const int true_north = MAGCOMP_NORTH_TRUE;
    REFUSED(CONFIG, "MAGCOMP_NORTH_NONE", magcomp_compensator_push_heading(c, 0, 90, 5, MAGCOMP_NORTH_NONE, top));
    REFUSED(CONFIG, "reference is 7", magcomp_compensator_push_heading(c, 0, 90, 5, 7, top));
    REFUSED(CONFIG, "reference is -1", magcomp_compensator_push_attitude(c, 0, 1, 0, 0, 0, -1, 5));
    REFUSED(EVENT_NOT_FINITE, "not finite", magcomp_compensator_push_heading(c, 0, NAN, 5, true_north, top));
    REFUSED(EVENT_OUT_OF_RANGE, "range", magcomp_compensator_push_heading(c, 0, 90, 0, true_north, top));
    REFUSED(EVENT_OUT_OF_RANGE, "range", magcomp_compensator_push_heading(c, 0, 361, 5, true_north, top));
    REFUSED(EVENT_OUT_OF_RANGE, "range", magcomp_compensator_push_heading(c, 0, 90, 5, true_north, zero));
    REFUSED(EVENT_NOT_FINITE, "not finite", magcomp_compensator_push_attitude(c, 0, INFINITY, 0, 0, 0, MAGCOMP_NORTH_NONE, 0));
    REFUSED(EVENT_OUT_OF_RANGE, "range", magcomp_compensator_push_attitude(c, 0, 0, 0, 0, 0, MAGCOMP_NORTH_NONE, 0));
    REFUSED(NOTHING_YET, "headings from true north", magcomp_compensator_found_declination(c, &declination_deg, &sigma_deg));
    CHECK(isnan(declination_deg) && isnan(sigma_deg));
    CHECK(magcomp_compensator_push_heading(c, 1, 90, 5, true_north, NULL) == MAGCOMP_ERROR_NONE);
    REFUSED(EVENT_DUPLICATE, "same time", magcomp_compensator_push_heading(c, 1, 90, 5, true_north, NULL));
    CHECK(magcomp_compensator_push_attitude(c, 2, 3, 0, 0, 0, MAGCOMP_NORTH_NONE, NAN) == MAGCOMP_ERROR_NONE);
    REFUSED(EVENT_LATE, "older", magcomp_compensator_push_attitude(c, 2, 3, 0, 0, 0, MAGCOMP_NORTH_NONE, NAN));
    magcomp_compensator_free(c);

    const magcomp_calibration rough = {sizeof rough, {1, 0, 0, 0, 1, 0, 0, 0, 1}, {0, 0, 0}, 49.244};
    for (int as_attitude = 0; as_attitude < 2; as_attitude++) {
        c = made(NULL);
        CHECK(magcomp_compensator_adopt_calibration(c, &rough, 30) == MAGCOMP_ERROR_NONE);
        magcomp_reading r = {.size = 0};
        const double half = -15 * 3.141592653589793 / 180;
        for (int k = 1; k < 3000; k++) {
            const int64_t t = k * 2 * STEP_NS;
            CHECK(magcomp_compensator_push_rotation_rate(c, t, 0, 0, 0) == MAGCOMP_ERROR_NONE);
            CHECK(magcomp_compensator_push_up(c, t, 0, 0, 9.81) == MAGCOMP_ERROR_NONE);
            if (k % 50 == 0 && as_attitude)
                CHECK(magcomp_compensator_push_attitude(c, t, cos(half), 0, 0, sin(half), MAGCOMP_NORTH_MAGNETIC, 1) == MAGCOMP_ERROR_NONE);
            if (k % 50 == 0 && !as_attitude) CHECK(magcomp_compensator_push_heading(c, t, 30, 1, true_north, top) == MAGCOMP_ERROR_NONE);
            r = pushed(c, t, 0.2 * sin(1.7 * k * k), 20, -45);
        }
        const magcomp_error found = magcomp_compensator_found_declination(c, &declination_deg, &sigma_deg);
        if (as_attitude) {
            CHECK(magcomp_compensator_heading_aid(c) == MAGCOMP_HEADING_AID_LEADS && fabs(r.heading_deg - 30) < 5);
            CHECK(found == MAGCOMP_ERROR_NOTHING_YET && isnan(declination_deg));
        } else {
            /* from true north: the difference may be the declination */
            CHECK(magcomp_compensator_heading_aid(c) != MAGCOMP_HEADING_AID_NONE && fabs(r.true_heading_deg - 30) < 5);
            CHECK(found == MAGCOMP_ERROR_NONE && isfinite(declination_deg) && sigma_deg > 0);
        }
        magcomp_compensator_free(c);
    }
}

static void fits(void) {
    magcomp_compensator *const c = NULL; /* REFUSED reads this thread's message */
    enum { COUNT = 500 };
    double points[COUNT][3];
    for (int k = 0; k < COUNT; k++) {
        const double up = 1 - (2 * k + 1) / (double)COUNT, across = sqrt(1 - up * up), turn = 2.4 * k;
        const double direction[3] = {across * cos(turn), across * sin(turn), up};
        for (int axis = 0; axis < 3; axis++) points[k][axis] = 48 * direction[axis] + B_UT[axis] + 0.3 * sin(1.7 * k * k + axis);
    }
    magcomp_calibration found = {.size = sizeof found};
    magcomp_fit fit = {.size = sizeof fit};
    CHECK(magcomp_fit_ellipsoid(points[0], COUNT, NAN, &found, &fit) == MAGCOMP_ERROR_NONE);
    CHECK(found.size == sizeof found && fit.size == sizeof fit && fit.problem == MAGCOMP_FIT_PROBLEM_NONE);
    for (int axis = 0; axis < 3; axis++) CHECK(fabs(found.hard_iron_ut[axis] - B_UT[axis]) < 0.1);
    CHECK(fabs(found.field_strength_ut - 48) < 0.1 && fit.residual_rms_ut > 0.1 && fit.residual_rms_ut < 0.4);
    for (int row = 0; row < 9; row++) {
        CHECK(fit.covariance[10 * row] > 0);
        for (int column = 0; column < row; column++) CHECK(fit.covariance[9 * row + column] == fit.covariance[9 * column + row]);
    }
    /* the strength may be given, the fit may be left out, and a compensator begins with it */
    CHECK(magcomp_fit_ellipsoid(points[0], COUNT, 50, &found, NULL) == MAGCOMP_ERROR_NONE && found.field_strength_ut == 50);
    magcomp_compensator *begun = made(NULL);
    CHECK(magcomp_compensator_adopt_calibration(begun, &found, 2) == MAGCOMP_ERROR_NONE);
    magcomp_compensator_free(begun);

    const magcomp_calibration before = found;
    REFUSED(NULL_POINTER, "points_ut", magcomp_fit_ellipsoid(NULL, COUNT, NAN, &found, &fit));
    REFUSED(NULL_POINTER, "magcomp_calibration", magcomp_fit_ellipsoid(points[0], COUNT, NAN, NULL, &fit));
    REFUSED(FIT, "too few", magcomp_fit_ellipsoid(points[0], 8, NAN, &found, &fit));
    CHECK(fit.problem == MAGCOMP_FIT_PROBLEM_TOO_FEW_SAMPLES && isnan(fit.covariance[80]) && isnan(fit.residual_rms_ut));
    REFUSED(FIT, "too few", magcomp_fit_ellipsoid(points[0], 0, NAN, &found, NULL));
    const double strengths[] = {-50, 0, 0.5, 1001, INFINITY};
    for (size_t k = 0; k < sizeof strengths / sizeof *strengths; k++) {
        REFUSED(CONFIG, "field_strength_ut", magcomp_fit_ellipsoid(points[0], COUNT, strengths[k], &found, &fit));
    }
    points[7][1] = NAN;
    REFUSED(FIT, "not finite", magcomp_fit_ellipsoid(points[0], COUNT, NAN, &found, &fit));
    CHECK(fit.problem == MAGCOMP_FIT_PROBLEM_NOT_FINITE);
    for (int k = 0; k < COUNT; k++) points[k][2] = 0;
    points[7][1] = 0;
    REFUSED(FIT, "plane", magcomp_fit_ellipsoid(points[0], COUNT, NAN, &found, &fit));
    CHECK(fit.problem == MAGCOMP_FIT_PROBLEM_PLANAR && memcmp(&before, &found, sizeof found) == 0);
    fit.size = 3;
    REFUSED(SIZE, "sizeof(magcomp_fit), 680", magcomp_fit_ellipsoid(points[0], COUNT, NAN, &found, &fit));
}

static void covariances(void) {
    magcomp_compensator *c = NULL;
    double covariance[81] = {0};
    REFUSED(NULL_POINTER, "compensator", magcomp_compensator_covariance(c, covariance));
    c = made(NULL);
    REFUSED(NULL_POINTER, "covariance", magcomp_compensator_covariance(c, NULL));
    REFUSED(NOTHING_YET, "no calibration yet", magcomp_compensator_covariance(c, covariance));
    (void)turned(c, 0, 3000);
    CHECK(magcomp_compensator_covariance(c, covariance) == MAGCOMP_ERROR_NONE);
    for (int k = 0; k < 9; k++) CHECK(covariance[10 * k] > 0 && covariance[10 * k] < (k < 3 ? 4 : 0.01));
    magcomp_compensator_free(c);
}

static long allocations;

static void counted(const volatile void *at, size_t size) {
    (void)at, (void)size;
    allocations++;
}

static void freed(const volatile void *at) { (void)at; }

/* AddressSanitizer's, whose header not every compiler brings */
int __sanitizer_install_malloc_and_free_hooks(void (*)(const volatile void *, size_t), void (*)(const volatile void *));

static void memory(void) {
    CHECK(__sanitizer_install_malloc_and_free_hooks(counted, freed) != 0);
    magcomp_compensator *c = made(NULL);
    CHECK(allocations > 0);
    allocations = 0;
    (void)turned(c, 0, 3000);
    CHECK(allocations == 0);
    REFUSED(CONFIG, "hidden_s", magcomp_compensator_push_gap(c, -1));
    CHECK(allocations > 0);
    magcomp_compensator_free(c);
}

int main(void) {
    CHECK(strcmp(magcomp_version(), VERSION) == 0);
    char compiled_for[32];
    snprintf(compiled_for, sizeof compiled_for, "%d.%d.%d", MAGCOMP_VERSION_MAJOR, MAGCOMP_VERSION_MINOR, MAGCOMP_VERSION_PATCH);
    CHECK(strcmp(compiled_for, VERSION) == 0);
    configs();
    typed_configs();
    nulls();
    sizes();
    samples();
    gaps();
    calibrations();
    headings();
    from_outside();
    fits();
    covariances();
    memory();
    return 0;
}
