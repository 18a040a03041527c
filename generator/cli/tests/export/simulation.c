/* Prints the events of two seconds of the double pendulum and where it is then, with mistakes among the calls; then the
   accelerations and kinetic energies of the states on its standard input. */
#include "planar_double_pendulum_simulation.h"

#include <stdio.h>
#include <string.h>

#define OK PLANAR_DOUBLE_PENDULUM_OK
#define REFUSED PLANAR_DOUBLE_PENDULUM_REFUSED

typedef planar_double_pendulum_simulation simulation;

static int begin(const planar_double_pendulum *pendulum, const planar_double_pendulum_coordinates *q,
    const planar_double_pendulum_speeds *u, const planar_double_pendulum_surface *surface, simulation **motion)
{
    *motion = NULL;
    return planar_double_pendulum_simulation_new(pendulum, 0, q, u, 1e-12, surface, motion);
}

static int says(const simulation *motion, const char *what)
{
    return strstr(planar_double_pendulum_simulation_message(motion), what) != NULL;
}

int main(void)
{
    planar_double_pendulum pendulum;
    planar_double_pendulum_parameters parameters;
    planar_double_pendulum_coordinates q;
    planar_double_pendulum_speeds u, rates;
    planar_double_pendulum_surface surface = {0.3, 0.5, PLANAR_DOUBLE_PENDULUM_STRONGE};
    planar_double_pendulum_event event = {0};
    simulation *motion;
    double force[3] = {7, 7, 7}, energy;
    int progress;

    if (planar_double_pendulum_default_parameters(&parameters) != OK || planar_double_pendulum_new(&parameters, &pendulum) != OK)
        return 1;
    if (planar_double_pendulum_default_coordinates(&q) != OK || planar_double_pendulum_default_speeds(&u) != OK)
        return 2;

    /* Null pointers and unknown laws make no motion. */
    if (begin(NULL, &q, &u, &surface, &motion) != PLANAR_DOUBLE_PENDULUM_NULL || begin(&pendulum, &q, &u, NULL, &motion) != PLANAR_DOUBLE_PENDULUM_NULL)
        return 3;
    surface.law = 9;
    if (begin(&pendulum, &q, &u, &surface, &motion) != PLANAR_DOUBLE_PENDULUM_UNKNOWN_LAW || motion != NULL)
        return 4;
    if (planar_double_pendulum_simulation_advance(NULL, 1, &event) != REFUSED || !says(NULL, "there is no motion"))
        return 5;
    planar_double_pendulum_simulation_free(NULL);
    surface.law = PLANAR_DOUBLE_PENDULUM_STRONGE;

    /* A motion that cannot begin says why. */
    surface.mu = -1;
    if (begin(&pendulum, &q, &u, &surface, &motion) != REFUSED || !says(motion, "friction"))
        return 6;
    if (planar_double_pendulum_simulation_advance(motion, 1, &event) != REFUSED || !says(motion, "friction"))
        return 7;
    if (planar_double_pendulum_simulation_state(motion, &q, &u) != REFUSED || !(planar_double_pendulum_simulation_time(motion) != 0))
        return 8;
    planar_double_pendulum_simulation_free(motion);
    surface.mu = 0.3;

    if (begin(&pendulum, &q, &u, &surface, &motion) != OK)
        return 9;
    /* A time that is none is refused, and nothing changes. */
    if (planar_double_pendulum_simulation_advance(motion, 0.0 / 0.0, &event) != REFUSED || !says(motion, "must be finite") || event.time != 0)
        return 10;
    while ((progress = planar_double_pendulum_simulation_advance(motion, 2, &event)) == PLANAR_DOUBLE_PENDULUM_AT_EVENT) {
        if (planar_double_pendulum_simulation_time(motion) != event.time)
            return 11;
        printf("event %.17g %d %d %.17g %.17g %.17g %.17g\n", event.time, (int)event.kind, (int)event.contact, event.energy_change,
            event.impulse_on_point[0], event.impulse_on_point[1], event.impulse_on_point[2]);
    }
    if (progress != PLANAR_DOUBLE_PENDULUM_REACHED || planar_double_pendulum_simulation_time(motion) != 2)
        return 12;
    if (planar_double_pendulum_simulation_force(motion, 1, force) != REFUSED || !says(motion, "there is no contact 1") || force[0] != 7)
        return 13;
    if (planar_double_pendulum_simulation_force(motion, PLANAR_DOUBLE_PENDULUM_CONTACT_TIP_WALL, force) != OK || *planar_double_pendulum_simulation_message(motion) != 0)
        return 14;
    printf("force %.17g %.17g %.17g\n", force[0], force[1], force[2]);
    if (planar_double_pendulum_simulation_state(motion, &q, &u) != OK)
        return 15;
    printf("end %.17g %.17g %.17g %.17g\n", q.q1, q.q2, u.u1, u.u2);
    planar_double_pendulum_simulation_free(motion);

    while (scanf("%lf %lf %lf %lf", &q.q1, &q.q2, &u.u1, &u.u2) == 4) {
        if (planar_double_pendulum_accelerations(&pendulum, &q, &u, &rates) != OK || planar_double_pendulum_kinetic_energy(&pendulum, &q, &u, &energy) != OK)
            return 16;
        printf("state %.17g %.17g %.17g\n", rates.u1, rates.u2, energy);
    }
    return 0;
}
