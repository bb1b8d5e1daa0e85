"""Step solvers that the tests register: Newton by scipy, by the program's linear solver, and what a test writes down."""

from scipy.sparse.linalg import spsolve

GUARANTEE = "no surface passes through another in the motion of any iteration"


class Newton:
    """Its direction by scipy, the step bound and trials of the program."""

    name, guarantee = "plain_newton", GUARANTEE
    counters = {"plain_backtracks": "trials beyond the first", "plain_slope_J": ("steepest slope", "smallest")}

    def direct(self, step):
        matrix, right_side = step.system()
        step.direction = spsolve(matrix.tocsc(), right_side)

    def advance(self, step):
        self.backtracks = self.slope = 0.0
        for _ in step.iterations():
            if failure := self.direct(step):
                return failure
            self.slope = min(self.slope, step.slope)
            alpha = bound if (bound := step.bound()) == 1 else 0.8 * bound
            while alpha > 1e-14 and not self.goes(step, alpha):
                self.backtracks += 1
                alpha /= 2
            if alpha <= 1e-14:
                return "line_search_failed"
            step.accept()
            self.note(step)
            if step.converged():
                return "converged"
        return "iteration_cap"

    def goes(self, step, alpha):
        if not step.at_target:
            return step.feasible(alpha)
        trial = step.trial(alpha)
        return trial is not None and trial.falls_by(-1e-4 * alpha * step.slope)

    def note(self, step):
        step.counts |= {"plain_backtracks": self.backtracks, "plain_slope_J": self.slope}


class Solving(Newton):
    """Its direction by the linear solver of the program."""

    name, counters = "solving_newton", {}

    def direct(self, step):
        return step.solve()

    def note(self, step):
        pass


class Scripted(Solving):
    """Runs what a test hands it."""

    name, counters, script = "scripted", {"scripted_number": "what a test says"}, None

    def advance(self, step):
        return self.script(step) if self.script else super().advance(step)


def solved_by(config, name, **settings):
    return {**config, "step_solver": {"name": name, "tol_velocity_m_per_s": 1e-7, **settings}}


def touching(bb, config):
    """A simulation between two steps, with contacts."""
    sim = bb.Simulation(config)
    while not sim.record()["steps"] or sim.record()["steps"][-1]["contacts"]["total"] == 0:
        sim.step()
    return sim
