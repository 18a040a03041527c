//! One of several collisions in work, and what it needs next.

use nalgebra::{Vector2, Vector3};

use super::super::{
    collision::{Begun, Slid},
    contact::Contact,
    event_location::{Bracket, TRIALS},
    restitution::Restitution,
    sliding::STRETCHES,
    sliding_arc::{ArcNumbers, ArcPoint, SlidingArc},
    straight::{Slide, straight},
    target::Watched,
};
use crate::{Impact, ImpactError, Law, ReducedMatrix, Sensitivity, Surface};

/// A collision: reduced matrix, velocity of approach and surface.
pub(super) type Collision = (ReducedMatrix<f64>, Vector3<f64>, Surface<f64>);

/// What is computed for several collisions at once.
#[derive(Clone, Copy)]
pub(super) enum Piece {
    /// The coefficients of the arc.
    Chart,
    /// The series to the end of slip.
    Stop,
    /// How far the next stretch reaches, and where its event may lie: an event of v_n, I_n or work.
    StretchVelocity,
    StretchImpulse,
    StretchWork,
    /// A quadrature to a trial of the event.
    TrialVelocity,
    TrialImpulse,
    TrialWork,
    /// The same with the work integrated directly.
    DirectVelocity,
    DirectImpulse,
    DirectWork,
    /// The short steps from the last trial to the event.
    ShortVelocity,
    ShortImpulse,
    ShortWork,
    /// The sliding arc has ended.
    Conclusion,
    /// Something rare: the collision is solved alone.
    Alone,
}

impl Piece {
    pub const COUNT: usize = 16;
    pub const ALL: [Self; Self::COUNT] = [
        Self::Chart,
        Self::Stop,
        Self::StretchVelocity,
        Self::StretchImpulse,
        Self::StretchWork,
        Self::TrialVelocity,
        Self::TrialImpulse,
        Self::TrialWork,
        Self::DirectVelocity,
        Self::DirectImpulse,
        Self::DirectWork,
        Self::ShortVelocity,
        Self::ShortImpulse,
        Self::ShortWork,
        Self::Conclusion,
        Self::Alone,
    ];

    fn by(watched: Watched, [velocity, impulse, work]: [Self; 3]) -> Self {
        match watched {
            Watched::Velocity => velocity,
            Watched::Impulse => impulse,
            Watched::Work => work,
        }
    }
}

/// A collision in work.
pub(super) struct Slot {
    /// Its place in the input.
    pub index: usize,
    /// The reduced matrix, the velocity of approach, mu and e; one number fills the last four.
    pub input: [f64; 12],
    law: Law,
    /// The contact and its mu, slip at the start, its length and the rounding error of h, in the units of the solver.
    pub start: [f64; 12],
    sensitivity: Sensitivity,
    restitution: Restitution<f64>,
    /// The numbers of the arc.
    pub arc: ArcNumbers<f64>,
    may_turn: bool,
    /// The beginning of the stretch, and the latest trial.
    pub at: [f64; 8],
    pub to: [f64; 8],
    /// How the arc has ended.
    slide: Slide<f64>,
    stretches: u32,
    fast: bool,
    stops: bool,
    /// Whether the event of the stretch ends the collision; the quantity that it watches, and its target.
    ends: bool,
    watched: Watched,
    pub target: f64,
    /// The length of a stretch that one quadrature allows.
    pub reach: f64,
    pub guess: f64,
    rising: bool,
    pub bracket: Bracket<f64>,
    trial: u32,
}

/// What is known of a collision with its arc: whether the usual ways lead to its end.
pub(super) struct Chart {
    pub usual: bool,
    pub no_slip: bool,
    pub unstable_direction: bool,
    pub may_turn: bool,
}

/// What is known of a stretch before it is followed.
pub(super) struct Stretch {
    pub over: bool,
    pub settled: bool,
    pub settles: bool,
    pub rising: bool,
    pub reach: f64,
    pub guess: f64,
}

/// What a trial has found: the residual of the event, the step to it, and whether short steps lead to it.
pub(super) struct Trial {
    pub residual: f64,
    pub step: f64,
    pub near: bool,
}

impl Slot {
    /// An empty slot.
    pub fn new() -> Self {
        let restitution = Restitution::new(Law::Poisson, 0.0);
        Self {
            index: 0,
            input: [0.0; 12],
            law: Law::Poisson,
            start: [0.0; 12],
            sensitivity: Sensitivity::default(),
            restitution,
            arc: [0.0; 24],
            may_turn: false,
            at: [0.0; 8],
            to: [0.0; 8],
            slide: Slide::Endless(restitution.start()),
            stretches: 0,
            fast: false,
            stops: false,
            ends: false,
            watched: Watched::Velocity,
            target: 0.0,
            reach: 0.0,
            guess: 0.0,
            rising: true,
            bracket: Bracket::new(0.0, 0.0),
            trial: 0,
        }
    }

    /// Takes a collision.
    #[inline(always)]
    pub fn take(&mut self, index: usize, (m, v, surface): &Collision) {
        self.index = index;
        let Surface { mu, e, law } = *surface;
        self.input = [m.nn, m.nt, m.ns, m.tt, m.ts, m.ss, v.x, v.y, v.z, mu, e, e];
        self.law = law;
    }

    /// The collision.
    #[inline(always)]
    pub fn collision(&self) -> Collision {
        let [nn, nt, ns, tt, ts, ss, n, t, s, mu, e, _] = self.input;
        let surface = Surface { mu, e, law: self.law };
        (ReducedMatrix::new(nn, nt, ns, tt, ts, ss), Vector3::new(n, t, s), surface)
    }

    fn arc(&self) -> SlidingArc<f64> {
        SlidingArc::of(&self.arc, self.may_turn)
    }

    #[inline(always)]
    fn contact(&self) -> Contact<f64> {
        let [nt, ns, tt, ts, ss, mu, ..] = self.start;
        Contact::of([nt, ns, tt, ts, ss], mu)
    }

    /// The length of slip at the start.
    fn slip(&self) -> f64 {
        self.start[8]
    }

    /// The outcome, from the end of the sliding arc.
    #[inline(always)]
    pub fn concluded(&mut self) -> Result<Impact<f64>, ImpactError<f64>> {
        let (matrix, approach, surface) = self.collision();
        let [.., t, s, slip, _, _, _] = self.start;
        let begun = Begun {
            matrix: &matrix,
            approach: &approach,
            speed: -approach.x,
            surface: &surface,
            contact: &self.contact(),
            share: 1.0,
            tangential: &Vector2::new(t, s),
            slip,
        };
        let mut slid = Slid::none(&self.restitution);
        // No budget can be exceeded.
        let _none = slid.ends(self.slide, &mut self.restitution);
        begun.concluded(&mut slid, true, &mut self.restitution, &mut self.sensitivity)
    }

    fn slide(&mut self, slide: Slide<f64>) -> Piece {
        self.slide = slide;
        Piece::Conclusion
    }

    /// The arc is known.
    #[inline(always)]
    pub fn charted(&mut self, w: f64, chart: &Chart) -> Piece {
        if !chart.usual {
            return Piece::Alone;
        }
        let [.., e, _] = self.input;
        self.restitution = Restitution::new(self.law, e);
        let (no_slip, unstable_direction) = (chart.no_slip, chart.unstable_direction);
        self.sensitivity = Sensitivity { no_slip, unstable_direction, ..Sensitivity::default() };
        self.stretches = 0;
        self.may_turn = chart.may_turn;
        let arc = self.arc();
        let sigma = self.slip() / arc.e(w);
        self.stops = arc.last_rate() < 0.0;
        self.at = ArcPoint { state: self.restitution.start(), since: 0.0, w, sigma }.numbers();
        self.stretch()
    }

    /// The next stretch begins at `at`.
    fn stretch(&mut self) -> Piece {
        let at = ArcPoint::of(self.at);
        if self.stretches == STRETCHES {
            return self.slide(Slide::Endless(at.state));
        }
        self.stretches += 1;
        let slip = at.sigma * self.arc().e(at.w);
        self.fast = self.restitution.fast(&self.contact(), slip);
        self.ends = at.state.velocity >= 0.0 || self.restitution.skips_compression();
        let law = self.restitution.law().watched();
        (self.watched, self.target) = match law {
            _ if !self.ends => (Watched::Velocity, 0.0),
            Watched::Work => (law, self.restitution.wanted),
            _ => (law, self.restitution.target),
        };
        Piece::by(self.watched, [Piece::StretchVelocity, Piece::StretchImpulse, Piece::StretchWork])
    }

    /// What is known of the stretch decides how it is followed.
    pub fn surveyed(&mut self, stretch: &Stretch) -> Piece {
        if stretch.over || stretch.settled {
            let (at, arc) = (ArcPoint::of(self.at), self.arc());
            let slip = at.sigma * arc.e(at.w);
            self.restitution.since(&at.state, at.since);
            let direction = arc.slip(&at) / slip;
            let slide = straight(&self.contact(), direction, slip, at.state, &mut self.restitution);
            return self.slide(slide);
        }
        self.reach = stretch.reach;
        self.guess = stretch.guess;
        self.rising = stretch.rising;
        if self.stops && !self.fast && stretch.settles && !self.turns_ahead() {
            return Piece::Stop;
        }
        self.follow()
    }

    fn turns_ahead(&self) -> bool {
        self.may_turn && self.arc().turns_ahead(&ArcPoint::of(self.at))
    }

    /// Slip stops at `to`, unless an event comes first.
    pub fn stopped(&mut self) -> Piece {
        let ArcPoint { state: stop, since, .. } = ArcPoint::of(self.to);
        if self.restitution.passes(&ArcPoint::of(self.at).state, &stop, self.contact().together(stop.normal))
        {
            self.restitution.since(&stop, since);
            return self.slide(Slide::Stopped(stop));
        }
        self.follow()
    }

    /// The first trial of the event.
    fn follow(&mut self) -> Piece {
        let mut limit = self.reach;
        let at = ArcPoint::of(self.at);
        if self.may_turn {
            let arc = self.arc();
            let (rising, turning_point) = arc.turning_point(&at, &arc.rates(&at));
            self.rising = rising;
            if let Some(length) = turning_point
                && length < limit
            {
                limit = length;
            }
        }
        self.fast = self.fast || self.restitution.delicate();
        if !self.rising {
            self.bracket.x = limit;
            return self.try_at_x();
        }
        let residual = match self.watched {
            Watched::Velocity => at.state.velocity,
            Watched::Impulse => at.state.normal,
            Watched::Work => at.since,
        } - self.target;
        if residual >= 0.0 {
            self.to = self.at;
            return self.reached(true);
        }
        (self.bracket, self.trial) = (Bracket::new(self.guess, limit), 0);
        self.try_at_x()
    }

    fn try_at_x(&self) -> Piece {
        let pieces = if self.fast {
            [Piece::DirectVelocity, Piece::DirectImpulse, Piece::DirectWork]
        } else {
            [Piece::TrialVelocity, Piece::TrialImpulse, Piece::TrialWork]
        };
        Piece::by(self.watched, pieces)
    }

    /// A trial is done: `to` is its end.
    pub fn tried(&mut self, trial: &Trial) -> Piece {
        if !self.rising {
            return self.fallen(trial.residual);
        }
        if self.bracket.passes(trial.residual < 0.0) {
            return self.reached(false);
        }
        if trial.near || self.bracket.is_narrow() {
            if trial.step < -self.bracket.x {
                self.to = self.at;
                return self.reached(true);
            }
            let pieces = [Piece::ShortVelocity, Piece::ShortImpulse, Piece::ShortWork];
            return Piece::by(self.watched, pieces);
        }
        self.bracket.move_on(self.bracket.x + trial.step, self.trial);
        self.trial += 1;
        if self.trial == TRIALS { Piece::Alone } else { self.try_at_x() }
    }

    /// v_n has fallen over the whole stretch, to `to`, where this is the residual of the event.
    fn fallen(&mut self, residual: f64) -> Piece {
        let (from, to) = (ArcPoint::of(self.at).state.velocity, ArcPoint::of(self.to).state.velocity);
        let restitutes = from >= 0.0;
        if restitutes && (to < 0.0 || !(self.watched == Watched::Velocity || residual < 0.0)) {
            return Piece::Alone;
        }
        self.at = self.to;
        self.restitution.grazing.moved(to);
        self.stretch()
    }

    /// The stretch ends at `to`, at its event or without one.
    pub fn reached(&mut self, found: bool) -> Piece {
        let restitution = &mut self.restitution;
        let (at, mut to) = (ArcPoint::of(self.at), ArcPoint::of(self.to));
        let ended = if self.ends {
            if at.state.velocity < 0.0 && (found || to.state.velocity >= 0.0) {
                restitution.compressed_somewhere();
            }
            if found && restitution.watches(Watched::Velocity) {
                to.state.velocity = restitution.target;
            }
            found
        } else if !found {
            false
        } else if restitution.compressed(&to.state) {
            true
        } else {
            (to.state.velocity, to.since) = (0.0, 0.0);
            false
        };
        self.at = to.numbers();
        if ended {
            let slip = self.arc().slip(&to);
            return self.slide(Slide::Ended(to.state, slip));
        }
        restitution.grazing.moved(to.state.velocity);
        self.stretch()
    }
}
