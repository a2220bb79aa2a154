"""The amount in a sentence for people."""

from __future__ import annotations

from core.imagination.amount.result import Amount


def amount_sentence(amount: Amount) -> str:
    """Return what to put into the cup and how full the object becomes, or the refusal; without the warning.

    For example: "Put 60 candies into the cup: they fill it to 40 % of its height (31 % of the 192 that fit)."
    """
    if amount.refusal:
        return amount.refusal
    if amount.n_cups == 1:
        told = f"Put {candies(amount.n_total)} into the cup"
    else:
        counts = [str(n) for n in amount.n_per_cup]
        told = f"Pour {amount.n_cups} cups of {', '.join(counts[:-1])} and {counts[-1]} candies"
    they = "it fills" if amount.n_total == 1 else "they fill"
    share = f"{100 * amount.share_of_capacity:.0f} % of the {amount.n_fit} that fit"
    if amount.fill_share <= 0:
        return f"{told}: {share}."
    if amount.fill_share >= 1:
        return f"{told}: {they} it to its rim ({share})."
    return f"{told}: {they} it to {100 * amount.fill_share:.0f} % of its height ({share})."


def amount_text(amount: Amount) -> str:
    """Return the sentence of an amount with its warning, or its refusal."""
    return f"{amount_sentence(amount)} {amount.warning}".strip()


def candies(n: int) -> str:
    """Return a number of candies in words."""
    return "1 candy" if n == 1 else f"{n} candies"
