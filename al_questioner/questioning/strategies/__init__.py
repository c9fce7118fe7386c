"""What to ask next: the strategies, what they weigh, and where they are registered."""
